#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "exec/algorithms.hpp"
#include "fluid/particle_tree.hpp"
#include "step.hpp"

namespace pointskin::simulation {
namespace step {

/// Neighbours of all particles. Neighbour k of particle i is at i across + k along: a GPU reads one k of many particles
/// at once, a CPU all k of one.
struct NeighbourLists {
  ArrayView<std::int32_t> list;
  ArrayView<std::uint8_t> count;  // found, at most kMostNeighbours + 1
  std::int64_t across = 0, along = 0;

  [[nodiscard]] PSK_HD int size(std::int64_t i) const {
    return count[i] < kMostNeighbours ? count[i] : kMostNeighbours;
  }
  [[nodiscard]] PSK_HD std::int32_t& at(std::int64_t i, int k) const { return list[i * across + k * along]; }
};

/// Calls visit(j, d, squared, set) for every neighbour j of particle i and every image of one (of i itself, too) within
/// the radius; `set` says in which walls, 0 the particle itself. d leads from it to i. The order is fixed.
template <class Visit>
PSK_HD void for_each_near(const NeighbourLists& neighbours, ArrayView<const Vec3f> place, const Mirrors& mirrors,
                          std::int64_t i, const Visit& visit) {
  const Vec3f p = place[i];
  const int n = neighbours.size(i);
  const auto visit_images = [&](std::int32_t j, const Vec3f& other) {
    for (int set = mirrors.near; set != 0; set = (set - 1) & mirrors.near) {
      const Vec3f d = mirrors.from_image(p, other, set);
      const float squared = dot(d, d);
      if (squared < 1) visit(j, d, squared, set);
    }
  };
  for (int k = 0; k < n; ++k) {
    const std::int32_t j = neighbours.at(i, k);
    const Vec3f other = place[j];
    const Vec3f d = p - other;
    const float squared = dot(d, d);
    if (!(squared < 1)) continue;
    visit(j, d, squared, 0);
    if (mirrors.near != 0) visit_images(j, other);
  }
  if (mirrors.near != 0) visit_images(static_cast<std::int32_t>(i), p);
}

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

/// Unit vector from neighbour to particle and how far apart they are. Particles at one place part along x, by their
/// ids.
struct Apart {
  Vec3f direction;
  float distance;
};
PSK_HD inline Apart apart(const Vec3f& d, float squared, bool first) {
  constexpr float kOnePlace = 1e-12F;
  if (squared < kOnePlace) return {{first ? -1.0F : 1.0F, 0, 0}, 0};
  const float r = std::sqrt(squared);
  return {1 / r * d, r};
}

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

struct FindVelocities {
  float per_second;
  ArrayView<const Vec3f> start, place;
  ArrayView<Vec3f> velocity;
  PSK_HD void operator()(std::int64_t i) const { velocity[i] = per_second * (place[i] - start[i]); }
};

/// XSPH, and the densities of the new places: v_i + c sum_j (v_j - v_i) W_ij / rest density.
struct Smooth {
  StepSettings settings;
  ArrayView<const Vec3f> place, velocity;
  NeighbourLists neighbours;
  ArrayView<Vec3f> smoothed;
  ArrayView<float> density;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = place[i];
    const Vec3f v = velocity[i];
    float sum = 1;
    Vec3f change{};
    for_each_near(neighbours, place, settings.solids.mirrors(p), i,
                  [&](std::int32_t j, const Vec3f& /*d*/, float squared, int set) {
                    const float w = weight(squared);
                    sum += w;
                    change = change + w * (Mirrors::turned(velocity[j], set) - v);
                  });
    const KernelConstants& kernel = settings.kernel;
    smoothed[i] = v + settings.viscosity * kernel.per_weight * change;
    density[i] = sum * kernel.per_weight + settings.solids.cover(p, kernel).share;
  }
};

/// Curl of the velocities.
struct FindCurl {
  StepSettings settings;
  ArrayView<const Vec3f> place, velocity;
  NeighbourLists neighbours;
  ArrayView<Vec3f> curl;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = place[i];
    const Vec3f v = velocity[i];
    Vec3f sum{};
    for_each_near(neighbours, place, settings.solids.mirrors(p), i,
                  [&](std::int32_t j, const Vec3f& d, float squared, int set) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    sum = sum + cross(Mirrors::turned(velocity[j], set) - v, t * t * to.direction);
                  });
    curl[i] = settings.kernel.slope * sum;
  }
};

/// Vorticity confinement: pushes around places where the curl is largest, as much as the curl is long.
/// Source: Fedkiw, Stam & Jensen, "Visual simulation of smoke", 2001; Macklin & Mueller 2013, section 5.
struct Confine {
  StepSettings settings;
  ArrayView<const Vec3f> place, curl;
  NeighbourLists neighbours;
  ArrayView<Vec3f> velocity;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = place[i];
    const float own = std::sqrt(dot(curl[i], curl[i]));
    Vec3f rise{};
    for_each_near(neighbours, place, settings.solids.mirrors(p), i,
                  [&](std::int32_t j, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float other = std::sqrt(dot(curl[j], curl[j]));
                    rise = rise - (other - own) * (t * t) * to.direction;
                  });
    const float length = std::sqrt(dot(rise, rise));
    if (!(length > 0)) return;
    velocity[i] = velocity[i] + settings.seconds * settings.vorticity / length * cross(rise, curl[i]);
  }
};

struct AddTotals {
  PSK_HD static float least(float a, float b) { return b < a ? b : a; }
  PSK_HD static float most(float a, float b) { return b > a ? b : a; }
  PSK_HD static Bounds join(const Bounds& a, const Bounds& b) {
    return {{least(a.lower.x, b.lower.x), least(a.lower.y, b.lower.y), least(a.lower.z, b.lower.z)},
            {most(a.upper.x, b.upper.x), most(a.upper.y, b.upper.y), most(a.upper.z, b.upper.z)}};
  }
  PSK_HD Totals operator()(const Totals& a, const Totals& b) const {
    return {a.compression + b.compression,
            a.squared_speed + b.squared_speed,
            a.height + b.height,
            join(a.box, b.box),
            most(a.most_compression, b.most_compression),
            most(a.fastest_squared, b.fastest_squared),
            a.crowded + b.crowded,
            a.lost + b.lost};
  }
};

struct TotalsOfParticle {
  ArrayView<const Vec3f> position, velocity;
  ArrayView<const float> density;
  ArrayView<const std::uint8_t> neighbours;
  Vec3f tank;

  PSK_HD Totals operator()(std::int64_t i) const {
    const Vec3f p = position[i];
    const Vec3f v = velocity[i];
    const float squared = dot(v, v);
    const float compression = density[i] > 1 ? density[i] - 1 : 0.0F;
    const bool inside = p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= tank.x && p.y <= tank.y && p.z <= tank.z;
    const bool finite = squared < 1e30F;  // false for NaN
    return {compression,
            squared,
            p.y,
            {p, p},
            compression,
            squared,
            neighbours[i] > kMostNeighbours ? 1 : 0,
            inside && finite ? 0 : 1};
  }
};

struct ToWorld {
  float radius;
  ArrayView<const Vec3f> position, velocity;
  WorldViews out;
  PSK_HD void operator()(std::int64_t i) const {
    out.positions[i] = radius * position[i];
    if (out.velocities[0].empty()) return;
    const Vec3f v = radius * velocity[i];
    out.velocities[0][i] = v.x;
    out.velocities[1][i] = v.y;
    out.velocities[2][i] = v.z;
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
  for_each(ex, "simulation.velocities", n,
           step::FindVelocities{1 / settings.seconds, start.cview(), place.cview(), velocity});
  if (settings.vorticity > 0) {
    for_each(ex, "simulation.curl", n,
             step::FindCurl{settings, place.cview(), velocity, neighbours, particles.velocity.view()});
    for_each(ex, "simulation.vorticity", n,
             step::Confine{settings, place.cview(), particles.velocity.cview(), neighbours, velocity});
  }
  for_each(
      ex, "simulation.viscosity", n,
      step::Smooth{settings, place.cview(), velocity, neighbours, particles.velocity.view(), particles.density.view()});
  particles.position.swap(place);
}

template <exec::Space Exec>
Totals totals_of(Exec& ex, const Particles& particles, const Solids& solids) {
  return exec::reduce<Totals>(
      ex, "simulation.totals", particles.position.size(),
      step::TotalsOfParticle{particles.position.cview(), particles.velocity.cview(), particles.density.cview(),
                             particles.neighbours.cview(), solids.tank},
      step::AddTotals{});
}

template <exec::Space Exec>
void to_world(Exec& ex, const Particles& particles, float radius_world, const WorldViews& out) {
  for_each(ex, "simulation.world", particles.position.size(),
           step::ToWorld{radius_world, particles.position.cview(), particles.velocity.cview(), out});
}

}  // namespace pointskin::simulation
