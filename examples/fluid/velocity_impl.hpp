// Velocities from the moves of a substep: XSPH, vorticity confinement.
#pragma once

#include <cmath>

#include "exec/algorithms.hpp"
#include "neighbours.hpp"
#include "step.hpp"

namespace pointskin::simulation::step {

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

/// Where particles were and are.
struct Ways {
  ArrayView<const Vec3f> start, place;
};

/// Writes velocities and densities of `particles`. @param velocity  scratch
template <exec::Space Exec>
void update_velocities(Exec& ex, Particles& particles, const StepSettings& settings, const NeighbourLists& neighbours,
                       const Ways& ways, ArrayView<Vec3f> velocity) {
  const std::int64_t n = particles.position.size();
  for_each(ex, "simulation.velocities", n, FindVelocities{1 / settings.seconds, ways.start, ways.place, velocity});
  if (settings.vorticity > 0) {
    for_each(ex, "simulation.curl", n, FindCurl{settings, ways.place, velocity, neighbours, particles.velocity.view()});
    for_each(ex, "simulation.vorticity", n,
             Confine{settings, ways.place, particles.velocity.cview(), neighbours, velocity});
  }
  for_each(ex, "simulation.viscosity", n,
           Smooth{settings, ways.place, velocity, neighbours, particles.velocity.view(), particles.density.view()});
}

}  // namespace pointskin::simulation::step
