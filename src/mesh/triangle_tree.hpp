// Nearest triangle of a mesh to a point, and triangles in the way of a line, by a tree of boxes.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>

#include "core/triangle_distance.hpp"
#include "exec/cpu_primitives.hpp"
#include "mesh/box_tree.hpp"
#include "mesh/nearest.hpp"

namespace pointskin::mesh_detail {

/// Triangle `id` of `mesh`, its corners moved by `offset`.
EdgedTriangle edged_triangle(const Mesh& mesh, const Vec3d& offset, std::int64_t id);

/// A BoxTree over the triangles of `mesh`, by the means of their corners, which are moved by `offset`.
/// Without an offset the boxes are exact.
/// @param mesh  at least one triangle, ids in range, corners finite
BoxTree tree_of_triangles(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset);

/// The triangles of a mesh, searched from points. Memory: 72 bytes a triangle and those of a BoxTree.
class TriangleTree {
 public:
  /// @param mesh    at least one triangle, ids in range, corners finite
  /// @param offset  added to every vertex
  /// O(t log t). Deterministic for any number of threads.
  TriangleTree(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset);

  /// The triangle nearest to `p`; of several at the same distance the one with the smallest id.
  /// @param hint  slot of a triangle that may be near, or -1; changes the time taken, not the answer
  /// About O(log t) for points near the surface; more where many triangles are about equally far.
  [[nodiscard]] Nearest nearest(const Vec3d& p, std::int32_t hint = -1) const;

  /// True if a triangle, of either side, crosses the line between two places. About O(log t).
  /// Source: Moller & Trumbore, "Fast, minimum storage ray/triangle intersection", Journal of Graphics Tools 2(1),
  /// 1997.
  [[nodiscard]] bool is_between(const Vec3d& from, const Vec3d& to) const;

  [[nodiscard]] const EdgedTriangle& triangle(std::int32_t slot) const { return triangles_.data()[slot]; }
  [[nodiscard]] std::int32_t id(std::int32_t slot) const { return tree_.id(slot); }

 private:
  BoxTree tree_;
  exec::Buffer<EdgedTriangle> triangles_;  // shape (t), by slot
};

}  // namespace pointskin::mesh_detail
