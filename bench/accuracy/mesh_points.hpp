// Points of a mesh, area-uniform: clouds of surfaces that have no formula.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include <cstdint>

namespace pointskin::bench {

/// Draws `points` places independently and area-uniformly from the triangles of `mesh`, with the normals of these.
/// @param points  > 0
/// @throws Error usage if `points` is not positive; empty_result if the mesh has no area
/// O(triangles + points log triangles). The same on every machine.
Cloud points_of(const Mesh& mesh, std::int64_t points, std::uint64_t seed);

}  // namespace pointskin::bench
