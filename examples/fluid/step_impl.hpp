#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "exec/algorithms.hpp"
#include "fluid/particle_tree.hpp"
#include "neighbours.hpp"
#include "step.hpp"
#include "velocity_impl.hpp"

namespace pointskin::simulation {
namespace step {

PSK_HD inline Vec3f acceleration_of(const Force& force, const Vec3f& p) {
  const Vec3f d = force.reach * (p - force.centre);
  const float t = 1 - dot(d, d);
  if (!(t > 0)) return {};
  return t * t * (force.swirls ? cross(force.along, d) : force.along);
}

/// Where particles would go without each other.
struct Predict {
  StepSettings settings;
  ArrayView<const Vec3f> position, velocity;
  ArrayView<Vec3f> predicted;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = position[i];
    Vec3f a{0, -settings.gravity, 0};
    for (int f = 0; f < settings.force_count; ++f) a = a + acceleration_of(settings.forces[f], p);
    Vec3f move = settings.seconds * (velocity[i] + settings.seconds * a);
    const float squared = dot(move, move);
    const float longest = settings.longest_move;
    if (squared > longest * longest) move = longest / std::sqrt(squared) * move;
    predicted[i] = settings.solids.confined(p + move);
  }
};

/// Into the order of the cells.
struct Reorder {
  ArrayView<const std::int32_t> order;
  ArrayView<const Vec3f> position, predicted;
  ArrayView<const std::int32_t> id;
  ArrayView<const float> multiplier;
  float warm_start;
  ArrayView<Vec3f> start, place;
  ArrayView<std::int32_t> new_id;
  ArrayView<float> sum;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t from = order[i];
    start[i] = position[from];
    place[i] = predicted[from];
    new_id[i] = id[from];
    sum[i] = warm_start * multiplier[from];
  }
};

struct FindNeighbours {
  fluid::ParticleTreeView tree;
  ArrayView<const Vec3f> place;
  NeighbourLists neighbours;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = place[i];
    int found = 0;
    fluid::for_each_neighbour(tree, tree.cell[i], [&](std::int32_t j) {
      const Vec3f d = p - place[j];
      if (j == i || !(dot(d, d) < 1) || found > kMostNeighbours) return;
      if (found < kMostNeighbours) neighbours.at(i, found) = j;
      ++found;
    });
    neighbours.count[i] = static_cast<std::uint8_t>(found);
  }
};

/// The multiplier of every particle's constraint, density <= rest density:
/// lambda_i = - C_i / (sum_k |grad_k C_i|^2 + epsilon), what solids cover counting as one neighbour.
struct FindMultipliers {
  StepSettings settings;
  ArrayView<const Vec3f> place;
  NeighbourLists neighbours;
  ArrayView<float> sum;   // of all iterations and the warm start, <= 0
  ArrayView<float> step;  // what is added to it

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = place[i];
    float weights = 1;
    float squares = 0;
    Vec3f gradient{};
    for_each_near(neighbours, place, settings.solids.mirrors(p), i,
                  [&](std::int32_t j, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float slope = t * t;
                    weights += weight(squared);
                    squares += slope * slope;
                    gradient = gradient - slope * to.direction;
                  });
    const KernelConstants& kernel = settings.kernel;
    const Cover cover = settings.solids.cover(p, kernel);
    const float compression = weights * kernel.per_weight + cover.share - 1;
    gradient = kernel.slope * gradient + cover.gradient;
    const float scale =
        kernel.slope * kernel.slope * squares + dot(gradient, gradient) + dot(cover.gradient, cover.gradient);
    const float before = sum[i];
    const float after = before - compression / (scale + settings.relaxation);
    sum[i] = after < 0 ? after : 0.0F;
    step[i] = sum[i] - before;
  }
};

/// Moves every particle by its own and its neighbours' constraints; solids press with the particle's own multiplier, as
/// a mirror image would.
struct Correct {
  StepSettings settings;
  ArrayView<const Vec3f> place;
  NeighbourLists neighbours;
  ArrayView<const float> multiplier;
  ArrayView<Vec3f> corrected;

  PSK_HD void operator()(std::int64_t i) const {
    constexpr float kLongest = 0.25F;  // of one correction
    const Vec3f p = place[i];
    const float own = multiplier[i];
    Vec3f sum{};
    for_each_near(neighbours, place, settings.solids.mirrors(p), i,
                  [&](std::int32_t j, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float w = weight(squared) * settings.kernel.tensile_inverse;
                    const float tensile = settings.artificial_pressure * (w * w) * (w * w);
                    sum = sum - (own + multiplier[j] - tensile) * (t * t) * to.direction;
                  });
    Vec3f move = settings.kernel.slope * sum;
    if (own != 0) move = move + 2 * own * settings.solids.cover(p, settings.kernel).gradient;
    const float squared = dot(move, move);
    if (squared > kLongest * kLongest) move = kLongest / std::sqrt(squared) * move;
    corrected[i] = settings.solids.confined(p + move);
  }
};

}  // namespace step

template <exec::Space Exec>
void substep(Exec& ex, Particles& particles, const StepSettings& settings, const fluid::CellGrid& grid) {
  const std::int64_t n = particles.position.size();
  auto predicted = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "simulation.predict", n,
           step::Predict{settings, particles.position.cview(), particles.velocity.cview(), predicted.view()});
  const fluid::ParticleTree tree = fluid::build_particle_tree(ex, predicted.cview(), grid);
  auto start = exec::make_buffer<Vec3f>(ex, n);
  auto place = exec::make_buffer<Vec3f>(ex, n);
  auto id = exec::make_buffer<std::int32_t>(ex, n);
  auto sum = exec::make_buffer<float>(ex, n);
  for_each(ex, "simulation.reorder", n,
           step::Reorder{tree.order.cview(), particles.position.cview(), predicted.cview(), particles.id.cview(),
                         particles.multiplier.cview(), settings.warm_start, start.view(), place.view(), id.view(),
                         sum.view()});
  particles.id.swap(id);
  particles.multiplier.swap(sum);

  auto list = exec::make_buffer<std::int32_t>(ex, n * kMostNeighbours);
  const step::NeighbourLists neighbours{list.view(), particles.neighbours.view(),
                                        Exec::kManyThreads ? 1 : kMostNeighbours, Exec::kManyThreads ? n : 1};
  for_each(ex, "simulation.neighbours", n, step::FindNeighbours{tree.view(), place.cview(), neighbours});

  const auto correct = [&](ArrayView<const float> multiplier) {
    for_each(ex, "simulation.correct", n,
             step::Correct{settings, place.cview(), neighbours, multiplier, predicted.view()});
    place.swap(predicted);
  };
  if (settings.warm_start > 0) correct(particles.multiplier.cview());
  exec::Buffer<float> change = std::move(sum);
  for (int i = 0; i < settings.iterations; ++i) {
    for_each(ex, "simulation.multipliers", n,
             step::FindMultipliers{settings, place.cview(), neighbours, particles.multiplier.view(), change.view()});
    correct(change.cview());
  }

  const ArrayView<Vec3f> velocity = predicted.view();  // its places are no longer needed
  step::update_velocities(ex, particles, settings, neighbours, {start.cview(), place.cview()}, velocity);
  particles.position.swap(place);
}

}  // namespace pointskin::simulation
