// The particles of a Simulation in a space, and what is asked of them.
#pragma once

#include <pointskin/simulation.hpp>

#include "exec/space.hpp"
#include "fluid/particle_tree.hpp"
#include "fluid/surface.hpp"
#include "simulation/step.hpp"

namespace pointskin::simulation {

struct FluidState {
  Particles particles;
  fluid::CellGrid grid;  ///< around the tank
  Bounds walls;          ///< metres
  float radius_world = 1;
};

/// A scene's particles where they are at first.
template <exec::Space Exec>
FluidState start_particles(Exec& ex, const Scene& scene, float radius_world);

/// Copies the particles to the host, in the scene's order.
template <exec::Space Exec>
ParticleStates copy_particles(Exec& ex, const FluidState& state);

/// The surface around the particles; see Simulation::surface. Values: velocities, with FluidOptions::attributes.
/// @param box  of the particles, as in Totals
template <exec::Space Exec>
fluid::FluidSurface surface_of(Exec& ex, const FluidState& state, const FluidOptions& options, const Bounds& box,
                               FluidReport& report);

/// What the values of that surface are called, by axis.
inline constexpr const char* kVelocityNames[3] = {"velocity_x", "velocity_y", "velocity_z"};

}  // namespace pointskin::simulation
