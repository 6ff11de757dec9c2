// Nearest triangle of a mesh to a point, and triangles in the way of a line, by a tree of boxes.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <limits>

#include "exec/cpu_primitives.hpp"
#include "mesh/triangle_distance.hpp"

namespace pointskin::mesh_detail {

/// Triangle `id` of `mesh`, its corners moved by `offset`.
EdgedTriangle edged_triangle(const Mesh& mesh, const Vec3d& offset, std::int64_t id);

/// What TriangleTree::nearest found.
struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  std::int32_t slot = -1;  ///< place of the triangle in the tree, see TriangleTree::triangle and id
};

/// A binary tree over the triangles of a mesh, halved at the median of the longest axis, a few triangles a leaf.
/// Memory: 76 bytes a triangle and 32 bytes a node, a node for every two triangles.
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
  [[nodiscard]] std::int32_t id(std::int32_t slot) const { return ids_.data()[slot]; }

  /// A box and what it holds. Nodes lie in preorder: the left child of an inner node follows it.
  struct Node {
    float lower[3], upper[3];  ///< rounded outwards
    std::int32_t right;        ///< right child, or -1 for a leaf
    std::int32_t first;        ///< leaf: its first slot
  };

 private:
  exec::Buffer<std::int32_t> ids_;         // shape (t), slot to id
  exec::Buffer<EdgedTriangle> triangles_;  // shape (t), by slot
  exec::Buffer<Node> nodes_;
};

}  // namespace pointskin::mesh_detail
