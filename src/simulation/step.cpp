#include "simulation/step.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "fluid/particle_tree.hpp"
#include "simulation/neighbours.hpp"
#include "simulation/velocity.hpp"

#include "exec/this_space.hpp"

namespace pointskin::simulation {
namespace {

using namespace step;

PSK_HD Vec3f acceleration_of(const Force& force, const Vec3f& p) {
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
  ArrayView<const float> multiplier, standing, missing;
  StepSettings settings;
  ArrayView<Vec3f> start;
  ArrayView<Placed> place;  // with what the last substep leaves of the multipliers
  ArrayView<std::int32_t> new_id;
  ArrayView<float> sum, new_standing, new_missing;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t from = order[i];
    start[i] = position[from];
    new_id[i] = id[from];
    new_missing[i] = missing[from];
    const float last = settings.rescale * multiplier[from];
    const float mean = settings.rescale * standing[from];
    new_standing[i] = mean + settings.mean_share * (last - mean);
    sum[i] = settings.warm_start * last + settings.standing * new_standing[i];
    place[i] = {predicted[from], sum[i]};
  }
};

/// Finds the neighbours of some lanes of a particle.
template <int Lanes>
struct FindNeighbours {
  fluid::ParticleTreeView tree;
  ArrayView<const Placed> particles;
  NeighbourLists<Lanes> neighbours;

  PSK_HD void of_lane(std::int64_t i, int lane) const {
    const std::int64_t list = i * Lanes + lane;
    const Vec3f p = particles[i].place;
    int found = 0;
    fluid::for_each_range_around(tree.level, tree.cell[i], [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first + ((lane - first) & (Lanes - 1)); j < last; j += Lanes) try_one(i, j, p, list, found);
    });
    neighbours.count[list] = static_cast<std::uint8_t>(found);
  }
  PSK_HD void of_all_lanes(std::int64_t i) const {
    const Vec3f p = particles[i].place;
    int found[Lanes] = {};
    fluid::for_each_range_around(tree.level, tree.cell[i], [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const int lane = j % Lanes;
        try_one(i, j, p, i * Lanes + lane, found[lane]);
      }
    });
    for (int lane = 0; lane < Lanes; ++lane)
      neighbours.count[i * Lanes + lane] = static_cast<std::uint8_t>(found[lane]);
  }
  PSK_HD void try_one(std::int64_t i, std::int32_t j, const Vec3f& p, std::int64_t list, int& found) const {
    const Vec3f d = p - particles[j].place;
    if (j == i || !(dot(d, d) < 1) || found > NeighbourLists<Lanes>::kMost) return;
    if (found < NeighbourLists<Lanes>::kMost) neighbours.at(list, found) = j;
    ++found;
  }
};
/// The same lists, by a thread each or by one a particle.
template <int Lanes>
struct FindNeighboursByLanes {
  FindNeighbours<Lanes> find;
  PSK_HD void operator()(std::int64_t list) const { find.of_lane(list / Lanes, static_cast<int>(list % Lanes)); }
};
template <int Lanes>
struct FindNeighboursAtOnce {
  FindNeighbours<Lanes> find;
  PSK_HD void operator()(std::int64_t i) const { find.of_all_lanes(i); }
};

/// The multiplier of every particle's constraint, density <= rest density:
/// lambda_i = - C_i / (sum_k |grad_k C_i|^2 + epsilon), what solids cover counting as one neighbour.
template <int Lanes>
struct FindMultipliers {
  static constexpr int kLanes = Lanes;
  struct Sum {
    float weights = 0, squares = 0;
    Vec3f gradient{};
    PSK_HD Sum operator+(const Sum& o) const {
      return {weights + o.weights, squares + o.squares, simulation::operator+(gradient, o.gradient)};
    }
  };

  StepSettings settings;
  ArrayView<const Placed> particles;
  NeighbourLists<Lanes> neighbours;
  ArrayView<const float> missing;
  ArrayView<float> sum;    // of all iterations and the warm start, <= 0
  ArrayView<Placed> step;  // the places with what is added to it

  [[nodiscard]] PSK_HD Sum part(std::int64_t i, int lane) const {
    Sum out;
    for_each_near(neighbours, particles, settings.solids.mirrors(particles[i].place), i, lane,
                  [&](std::int32_t j, float /*value*/, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float slope = t * t;
                    out.weights += weight(squared);
                    out.squares += slope * slope;
                    out.gradient = out.gradient - slope * to.direction;
                  });
    return out;
  }

  PSK_HD void finish(std::int64_t i, const Sum& near) const {
    const Vec3f p = particles[i].place;
    const KernelConstants& kernel = settings.kernel;
    const Cover cover = settings.solids.cover(p, kernel);
    const float compression = (1 + near.weights) * kernel.per_weight + cover.share + missing[i] - 1;
    const Vec3f gradient = kernel.slope * near.gradient + cover.gradient;
    const float scale =
        kernel.slope * kernel.slope * near.squares + dot(gradient, gradient) + dot(cover.gradient, cover.gradient);
    const float before = sum[i];
    const float after = before - compression / (scale + settings.relaxation);
    sum[i] = after < 0 ? after : 0.0F;
    step[i] = {p, sum[i] - before};
  }
};

/// Moves every particle by its own and its neighbours' constraints; solids press with the particle's own multiplier, as
/// a mirror image would.
template <int Lanes>
struct Correct {
  static constexpr int kLanes = Lanes;
  using Sum = VectorSum;

  StepSettings settings;
  ArrayView<const Placed> particles;  // with their multipliers
  NeighbourLists<Lanes> neighbours;
  ArrayView<Placed> corrected;

  [[nodiscard]] PSK_HD Sum part(std::int64_t i, int lane) const {
    const Placed own = particles[i];
    Vec3f sum{};
    for_each_near(neighbours, particles, settings.solids.mirrors(own.place), i, lane,
                  [&](std::int32_t j, float other, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float w = weight(squared) * settings.kernel.tensile_inverse;
                    const float tensile = settings.artificial_pressure * (w * w) * (w * w);
                    sum = sum - (own.value + other - tensile) * (t * t) * to.direction;
                  });
    return {sum};
  }

  PSK_HD void finish(std::int64_t i, const Sum& sum) const {
    constexpr float kLongest = 0.25F;  // of one correction
    const Placed own = particles[i];
    Vec3f move = settings.kernel.slope * sum.vector;
    if (own.value != 0) move = move + 2 * own.value * settings.solids.cover(own.place, settings.kernel).gradient;
    const float squared = dot(move, move);
    if (squared > kLongest * kLongest) move = kLongest / std::sqrt(squared) * move;
    corrected[i] = {settings.solids.confined(own.place + move), 0};
  }
};

}  // namespace

template <int Lanes, exec::Space Exec>
void substep_by_lanes(Exec& ex, Particles& particles, const StepSettings& settings, const fluid::CellGrid& grid) {
  const std::int64_t n = particles.position.size();
  auto predicted = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "simulation.predict", n,
           Predict{settings, particles.position.cview(), particles.velocity.cview(), predicted.view()});
  const fluid::ParticleTree tree = fluid::build_particle_tree(ex, predicted.cview(), grid);
  auto start = exec::make_buffer<Vec3f>(ex, n);
  auto now = exec::make_buffer<Placed>(ex, n);
  auto next = exec::make_buffer<Placed>(ex, n);
  auto id = exec::make_buffer<std::int32_t>(ex, n);
  auto sum = exec::make_buffer<float>(ex, n);
  auto standing = exec::make_buffer<float>(ex, n);
  auto missing = exec::make_buffer<float>(ex, n);
  for_each(ex, "simulation.reorder", n,
           Reorder{tree.order.cview(), particles.position.cview(), predicted.cview(), particles.id.cview(),
                   particles.multiplier.cview(), particles.standing.cview(), particles.missing.cview(), settings,
                   start.view(), now.view(), id.view(), sum.view(), standing.view(), missing.view()});
  particles.id.swap(id);
  particles.multiplier.swap(sum);
  particles.standing.swap(standing);
  particles.missing.swap(missing);

  const std::int64_t lists = n * Lanes;
  auto list = exec::make_buffer<std::int32_t>(ex, lists * NeighbourLists<Lanes>::kMost);
  const NeighbourLists<Lanes> neighbours{list.view(), particles.neighbours.view(),
                                         Exec::kManyThreads ? 1 : NeighbourLists<Lanes>::kMost,
                                         Exec::kManyThreads ? lists : 1};
  const FindNeighbours<Lanes> find{tree.view(), now.cview(), neighbours};
  if constexpr (Exec::kManyThreads)
    for_each(ex, "simulation.neighbours", lists, FindNeighboursByLanes<Lanes>{find});
  else
    for_each(ex, "simulation.neighbours", n, FindNeighboursAtOnce<Lanes>{find});

  const auto correct = [&] {
    for_each_by_lanes(ex, "simulation.correct", n, Correct<Lanes>{settings, now.cview(), neighbours, next.view()});
    now.swap(next);
  };
  if (settings.warm_start > 0 || settings.standing > 0) correct();
  for (int i = 0; i < settings.iterations; ++i) {
    for_each_by_lanes(ex, "simulation.multipliers", n,
                      FindMultipliers<Lanes>{settings, now.cview(), neighbours, particles.missing.cview(),
                                             particles.multiplier.view(), next.view()});
    now.swap(next);
    correct();
  }

  const ArrayView<Vec3f> velocity = predicted.view();  // its places are no longer needed
  update_velocities(ex, particles, settings, neighbours, start.cview(), now.cview(), velocity);
}

template <exec::Space Exec>
void substep(Exec& ex, Particles& particles, const StepSettings& settings, const fluid::CellGrid& grid) {
  if (lanes_for(particles.position.size()) == 1)
    substep_by_lanes<1>(ex, particles, settings, grid);
  else
    substep_by_lanes<4>(ex, particles, settings, grid);
}

PSK_INSTANTIATE(substep);

}  // namespace pointskin::simulation
