// Velocities from the moves of a substep: XSPH, vorticity confinement.
#pragma once

#include <cmath>

#include "exec/space.hpp"
#include "simulation/neighbours.hpp"
#include "simulation/step.hpp"

namespace pointskin::simulation::step {

struct FindVelocities {
  float per_second;
  ArrayView<const Vec3f> start;
  ArrayView<const Placed> particles;
  ArrayView<Vec3f> velocity;
  PSK_HD void operator()(std::int64_t i) const { velocity[i] = per_second * (particles[i].place - start[i]); }
};

/// XSPH, v_i + c sum_j (v_j - v_i) W_ij / rest density; the densities of the new places, and what the free surface
/// takes away of them. That is a mean over time: taken anew in every iteration it drives the surface to and fro.
template <int Lanes>
struct Smooth {
  static constexpr int kLanes = Lanes;
  struct Sum {
    float weights = 0;
    Vec3f change{}, moment{};
    PSK_HD Sum operator+(const Sum& o) const {
      return {weights + o.weights, simulation::operator+(change, o.change), simulation::operator+(moment, o.moment)};
    }
  };

  StepSettings settings;
  ArrayView<const Placed> particles;
  ArrayView<const Vec3f> velocity;
  NeighbourLists<Lanes> neighbours;
  ArrayView<Vec3f> position, smoothed;
  ArrayView<float> density, missing;

  [[nodiscard]] PSK_HD Sum part(std::int64_t i, int lane) const {
    const Vec3f v = velocity[i];
    Sum out;
    for_each_near(neighbours, particles, settings.solids.mirrors(particles[i].place), i, lane,
                  [&](std::int32_t j, float /*value*/, const Vec3f& d, float squared, int set) {
                    const float w = weight(squared);
                    out.weights += w;
                    out.moment = out.moment + w * d;
                    out.change = out.change + w * (Mirrors::turned(velocity[j], set) - v);
                  });
    return out;
  }

  PSK_HD void finish(std::int64_t i, const Sum& near) const {
    const Vec3f p = particles[i].place;
    const KernelConstants& kernel = settings.kernel;
    position[i] = p;
    smoothed[i] = velocity[i] + settings.viscosity * kernel.per_weight * near.change;
    const Cover cover = settings.solids.cover(p, kernel);
    density[i] = (1 + near.weights) * kernel.per_weight + cover.share;
    const Vec3f moment = kernel.per_weight * near.moment + cover.moment;
    const float now = missing_share(std::sqrt(dot(moment, moment)), kernel.surface);
    missing[i] = missing[i] + settings.missing_share * (now - missing[i]);
  }
};

/// Curl of the velocities.
template <int Lanes>
struct FindCurl {
  static constexpr int kLanes = Lanes;
  using Sum = VectorSum;

  StepSettings settings;
  ArrayView<const Placed> particles;
  ArrayView<const Vec3f> velocity;
  NeighbourLists<Lanes> neighbours;
  ArrayView<Vec3f> curl;

  [[nodiscard]] PSK_HD Sum part(std::int64_t i, int lane) const {
    const Vec3f v = velocity[i];
    Vec3f sum{};
    for_each_near(neighbours, particles, settings.solids.mirrors(particles[i].place), i, lane,
                  [&](std::int32_t j, float /*value*/, const Vec3f& d, float squared, int set) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    sum = sum + cross(Mirrors::turned(velocity[j], set) - v, t * t * to.direction);
                  });
    return {sum};
  }
  PSK_HD void finish(std::int64_t i, const Sum& sum) const { curl[i] = settings.kernel.slope * sum.vector; }
};

/// Vorticity confinement: pushes around places where the curl is largest, as much as the curl is long.
/// Source: Fedkiw, Stam & Jensen, "Visual simulation of smoke", 2001; Macklin & Mueller 2013, section 5.
template <int Lanes>
struct Confine {
  static constexpr int kLanes = Lanes;
  using Sum = VectorSum;

  StepSettings settings;
  ArrayView<const Placed> particles;
  ArrayView<const Vec3f> curl;
  NeighbourLists<Lanes> neighbours;
  ArrayView<Vec3f> velocity;

  [[nodiscard]] PSK_HD Sum part(std::int64_t i, int lane) const {
    const float own = std::sqrt(dot(curl[i], curl[i]));
    Vec3f rise{};
    for_each_near(neighbours, particles, settings.solids.mirrors(particles[i].place), i, lane,
                  [&](std::int32_t j, float /*value*/, const Vec3f& d, float squared, int /*set*/) {
                    const Apart to = apart(d, squared, i < j);
                    const float t = 1 - to.distance;
                    const float other = std::sqrt(dot(curl[j], curl[j]));
                    rise = rise - (other - own) * (t * t) * to.direction;
                  });
    return {rise};
  }
  PSK_HD void finish(std::int64_t i, const Sum& rise) const {
    const float length = std::sqrt(dot(rise.vector, rise.vector));
    if (!(length > 0)) return;
    velocity[i] = velocity[i] + settings.seconds * settings.vorticity / length * cross(rise.vector, curl[i]);
  }
};

/// Writes positions, velocities and densities of `particles`.
/// @param start, now  where they were and are
/// @param velocity    scratch
template <int Lanes, exec::Space Exec>
void update_velocities(Exec& ex, Particles& particles, const StepSettings& settings,
                       const NeighbourLists<Lanes>& neighbours, ArrayView<const Vec3f> start,
                       ArrayView<const Placed> now, ArrayView<Vec3f> velocity) {
  const std::int64_t n = now.size;
  for_each(ex, "simulation.velocities", n, FindVelocities{1 / settings.seconds, start, now, velocity});
  if (settings.vorticity > 0) {
    for_each_by_lanes(ex, "simulation.curl", n,
                      FindCurl<Lanes>{settings, now, velocity, neighbours, particles.velocity.view()});
    for_each_by_lanes(ex, "simulation.vorticity", n,
                      Confine<Lanes>{settings, now, particles.velocity.cview(), neighbours, velocity});
  }
  for_each_by_lanes(ex, "simulation.viscosity", n,
                    Smooth<Lanes>{settings, now, velocity, neighbours, particles.position.view(),
                                  particles.velocity.view(), particles.density.view(), particles.missing.view()});
}

}  // namespace pointskin::simulation::step
