// Normals of vertices from the faces around them.
#pragma once

#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin PSK_EXPORT {

/// Gives `mesh` vertex normals, in place of those it has: the mean of the faces' normals around a vertex, weighted by
/// their areas, at unit length. They point outward where triangles are counter-clockwise seen from outside. Vertices
/// that no triangle uses, or whose faces cancel, get zero normals.
/// O(v + t) time on one thread, 24 bytes a vertex of scratch. Deterministic.
/// @throws Error invalid_input if a triangle names a vertex that does not exist
void add_vertex_normals(Mesh& mesh);

}  // namespace pointskin
