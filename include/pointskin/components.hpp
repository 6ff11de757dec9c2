// The pieces that a mesh consists of, and a quick look at whether it is closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// The connected pieces of a mesh: triangles that share a vertex belong to the same one. Pieces are numbered in the
/// order of their smallest vertices.
struct MeshComponents {
  std::int64_t count = 0;
  std::vector<std::int32_t> of_vertex;  ///< shape (v), the piece of each vertex, in [0, count); -1: no triangle uses it
  std::vector<std::int64_t> triangles;  ///< shape (count)
  std::vector<double> areas;            ///< shape (count), world units^2
  std::vector<double> volumes;          ///< shape (count), signed as MeshReport::volume, meaningful for closed pieces;
                                        ///< world units^3

  /// The piece that `triangle` of the mesh belongs to.
  [[nodiscard]] std::int32_t of(const Triangle& triangle) const {
    return of_vertex[static_cast<std::size_t>(triangle[0])];
  }
};

/// Labels and measures the pieces of `mesh`. Their areas and volumes add up to those of the mesh.
/// O(v + t) time, about 9 bytes a vertex and 20 bytes a piece of scratch. Deterministic: the same labels and bits for
/// any `threads`.
/// @param threads  CPU threads, 0: all
/// @throws Error invalid_input if a triangle names a vertex that does not exist
MeshComponents label_components(const Mesh& mesh, int threads = 0);

/// What glance_at() sees.
struct MeshGlance {
  std::int64_t components = 0;  ///< connected by shared vertices
  bool closed = false;          ///< every edge has an even number of triangles, and there is one
  bool oriented = false;        ///< and each edge is run through as often in one direction as in the other
};

/// Counts the pieces of `mesh` and tells whether it is closed, in a fraction of the time of measure(). For meshes whose
/// edges have at most two triangles, as every reconstruction's have, `closed` is MeshReport::closed().
///
/// The edges of all triangles are added up as 64-bit checksums, in which two equal ones cancel: an open mesh is taken
/// for a closed one with a probability of 2^-64. Degenerate triangles have no edges, as in measure().
/// O(v + t) time, about 4 bytes a vertex and a quarter of a byte a triangle of scratch. Deterministic for any `threads`.
/// @param threads  CPU threads, 0: all
/// @throws Error invalid_input if a triangle names a vertex that does not exist
MeshGlance glance_at(const Mesh& mesh, int threads = 0);

/// The same of a mesh in the memory of `workspace`'s device, with scratch there. Waits.
/// @throws Error invalid_input if a triangle names a vertex that does not exist, over_limit (memory)
MeshGlance glance_at(const Workspace& workspace, const DeviceMesh& mesh);

}  // namespace pointskin
