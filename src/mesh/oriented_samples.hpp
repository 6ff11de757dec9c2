// A closed mesh as an oriented cloud.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin::mesh_detail {

/// Box of the vertices that triangles use, relative to Mesh::origin.
/// @throws Error invalid_input if the mesh is not closed, not oriented consistently, not finite or turned inside out
/// O(t log t). Deterministic for any `threads`.
Bounds bounds_of_solid(const Mesh& mesh, int threads);

/// Samples spread over the area, one for every `spacing` x `spacing`, with the normals of their triangles; relative to
/// Mesh::origin. Triangles without area get none.
/// @param spacing  world units, > 0
/// @throws Error over_limit for more than 2^31 - 1 samples
/// O(t + n log t). Deterministic for any `threads`.
Cloud sample_surface(const Mesh& mesh, double spacing, int threads);

}  // namespace pointskin::mesh_detail
