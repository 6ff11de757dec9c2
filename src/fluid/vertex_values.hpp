// Means of particles' values at the vertices of a surface, with the kernel of the surface, and the particles nearest to
// them.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "fluid/particle_tree.hpp"

namespace pointskin::fluid {

/// Particles in the order of the tree's keys, unit cube.
struct ParticlesView {
  ParticleTreeView tree;
  ArrayView<const Vec3f> positions;
  float radius = 0;  ///< of the kernel, unit cube
};

/// How many values share a pass over the particles.
inline constexpr int kValuesAtOnce = 4;

/// out[k][v] = sum k_j values[k][j] / sum k_j at vertex v, k_j = max(0, 1 - |x - p_j|^2 / R^2)^3, over the particles
/// whose value is finite, NaN where there are none; beyond R of all particles the value of the nearest.
struct VertexMeans {
  int count = 0;                            ///< in [1, kValuesAtOnce]
  const float* values[kValuesAtOnce] = {};  ///< (particles) in the order of the tree's keys
  float* out[kValuesAtOnce] = {};           ///< (vertices)
};
template <exec::Space Exec>
void average_at(Exec& ex, const ParticlesView& particles, ArrayView<const Vec3f> vertices, const VertexMeans& means);

/// Index of the particle nearest to each vertex among those within twice the kernel's radius that are not missing, or of
/// the nearest of all; of several as near, of the first in the order of the tree's keys; -1 if that one is missing.
/// @param order    (particles) the caller's index of each, in the order of the keys
/// @param missing  (particles) in the caller's order, 1: does not count; or (0)
/// @returns shape (vertices), the caller's indices
template <exec::Space Exec>
exec::Buffer<std::int32_t> nearest_at(Exec& ex, const ParticlesView& particles, ArrayView<const std::int32_t> order,
                                      ArrayView<const std::uint8_t> missing, ArrayView<const Vec3f> vertices);

/// How crowded particles are: sum over the others of 1 - |p_i - p_j|^2 / R^2 within R. 13 in the bulk, where R is four
/// particle radii. Source: as smooth() in fluid/mesh_graph.hpp.
template <exec::Space Exec>
exec::Buffer<float> crowding(Exec& ex, const ParticlesView& particles);

/// Weights of smoothing out of the crowding at vertices: s^3 (6 s^2 - 15 s + 10), s = min(1, crowding / bulk).
template <exec::Space Exec>
void to_smoothing_weights(Exec& ex, float bulk, ArrayView<float> values);

}  // namespace pointskin::fluid
