// The particles of a frame, ready for searches, and the fields and bands that are made of them.
#pragma once

#include <pointskin/fluid.hpp>

#include "exec/space.hpp"
#include "fluid/anisotropic.hpp"
#include "fluid/band.hpp"
#include "fluid/particle_tree.hpp"
#include "fluid/surface.hpp"
#include "fluid/zhu_bridson.hpp"

namespace pointskin::fluid {

/// Particles in the unit cube, sorted for searches.
struct SortedParticles {
  ParticleTree tree;
  exec::Buffer<Vec3f> positions;     ///< in the order of the tree's keys
  exec::Buffer<std::int32_t> order;  ///< the caller's index of each
};

/// Sorts particles into cells as wide as the kernel's radius. Their order does not matter unless they are canonical.
template <exec::Space Exec>
SortedParticles sort_particles(Exec& ex, const Particles& particles, const FluidFrame& frame);

/// The field of FluidKernel::isotropic. Refers to the particles.
ZhuBridsonField isotropic_field(const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options);

template <exec::Space Exec>
Band find_isotropic_band(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options,
                         const Walls& walls = {});

template <exec::Space Exec>
Ellipsoids ellipsoids_of(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options);

/// The field of FluidKernel::anisotropic. Refers to the ellipsoids.
AnisotropicField anisotropic_field(const Ellipsoids& ellipsoids, const FluidFrame& frame, const FluidOptions& options);

template <exec::Space Exec>
Band find_anisotropic_band(Exec& ex, const AnisotropicField& field, const FluidFrame& frame,
                           const FluidOptions& options, const Walls& walls = {});

}  // namespace pointskin::fluid
