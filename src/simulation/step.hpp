// One substep of position-based fluids.
// Sources: Macklin & Mueller, "Position based fluids", ACM Transactions on Graphics 32(4), 2013; Schechter & Bridson,
// "Ghost SPH for animating water", 2012 (XSPH as a filter of velocities).
// Differs: only compression is corrected (a surface does not pull itself together); at a free surface what is missing
// counts for the density (kernels.hpp); multipliers outlive the substep; walls are mirrors and the
// obstacle covers a share of the kernels near it, instead of being particles (kernels.hpp); the neighbours of the
// predicted places are found once a substep.
//
// Lengths are in kernel radii, times in seconds.
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "fluid/particle_tree.hpp"
#include "simulation/kernels.hpp"

namespace pointskin::simulation {

/// Lists that the neighbours of a particle are divided into (exec/lanes.hpp). Few particles leave most of a GPU idle if
/// each has one thread; many fill it, and then one thread a particle has the least to do.
inline constexpr int lanes_for(std::int64_t particles) { return particles < 1 << 18 ? 4 : 1; }

/// Neighbours that are kept in a list. At rest a particle has 26 within the radius; with more than this many in a list,
/// the last in the order of the cells are left out and the particle counts as crowded.
inline constexpr int most_neighbours(int lanes) { return lanes == 1 ? 64 : 24; }

/// As many forces may act at once.
inline constexpr int kMostInteractions = 8;

/// A force field; simulation::Interaction, ready for use.
struct Force {
  Vec3f centre{};
  Vec3f along{};    ///< acceleration at the centre (push), or the axis times the acceleration at the rim (swirl)
  float reach = 0;  ///< 1 / radius
  bool swirls = false;
};

/// What does not change within a substep. Small enough to travel as an argument.
struct StepSettings {
  float seconds = 0;
  float gravity = 0;       ///< downwards
  float longest_move = 1;  ///< of a substep: what is faster is slowed down
  float relaxation = 0;    ///< epsilon of the constraint
  float artificial_pressure = 0;
  float viscosity = 0;      ///< c of XSPH
  float vorticity = 0;      ///< 0: no confinement
  float warm_start = 0;     ///< what is left of the last substep's multipliers
  float standing = 0;       ///< part of their mean over time that is added
  float rescale = 1;        ///< of the multipliers: squared quotient of the substeps' lengths, this over the last
  float mean_share = 0;     ///< weight of the last substep's multiplier in that mean, in [0, 1]
  float missing_share = 0;  ///< weight of this substep in Particles::missing, in [0, 1]
  int iterations = 4;
  KernelConstants kernel{};
  Solids solids{};
  int force_count = 0;
  Force forces[kMostInteractions];
};

/// All that a simulation is: its particles, in the order of the cells that they were in last.
struct Particles {
  exec::Buffer<Vec3f> position;           ///< (n)
  exec::Buffer<Vec3f> velocity;           ///< (n) per second
  exec::Buffer<std::int32_t> id;          ///< (n) place in the scene
  exec::Buffer<float> multiplier;         ///< (n) of the last substep: minus the pressure, times seconds^2
  exec::Buffer<float> standing;           ///< (n) mean of the multipliers over time
  exec::Buffer<float> missing;            ///< (n) density that the free surface takes away, mean over time
  exec::Buffer<float> density;            ///< (n) over the density at rest, after the last substep
  exec::Buffer<std::uint8_t> neighbours;  ///< (n, lanes_for(n)) found in the last substep, at most
                                          ///< most_neighbours() + 1
};

/// Moves the particles on by one substep and puts them into the order of the cells of `grid`, which is around the tank.
/// 26 launches and one host round trip on a GPU with 4 iterations, two for each; O(n neighbours iterations).
/// Sums run in the order of the cells: the same bits in every space and for any number of threads.
template <exec::Space Exec>
void substep(Exec& ex, Particles& particles, const StepSettings& settings, const fluid::CellGrid& grid);

/// Sums over all particles. A particle's mass is 1.
struct Totals {
  double compression = 0;    ///< sum of max(0, density - 1)
  double squared_speed = 0;  ///< sum
  double height = 0;         ///< sum
  Bounds box{};              ///< of the particles
  float most_compression = 0;
  float fastest_squared = 0;
  std::int32_t crowded = 0;  ///< particles with more neighbours than are kept
  std::int32_t lost = 0;     ///< particles with a coordinate that is not finite or outside of the tank
};

/// n > 0. Three launches and a host round trip on a GPU, in a fixed order.
template <exec::Space Exec>
Totals totals_of(Exec& ex, const Particles& particles, const Solids& solids);

/// Positions and velocities in metres, each of shape (n).
struct WorldViews {
  ArrayView<Vec3f> positions;
  ArrayView<float> velocities[3];  ///< by axis; empty: not wanted
};

/// One launch. @param radius_world  the kernel's, metres
template <exec::Space Exec>
void to_world(Exec& ex, const Particles& particles, float radius_world, const WorldViews& out);

}  // namespace pointskin::simulation
