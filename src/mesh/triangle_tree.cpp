#include "mesh/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pointskin::mesh_detail {
namespace {

using Node = BoxTree::Node;

/// Whether the part of the line in [0, 1] meets the box. @param inverse  1 / line, infinite along axes it is level to
bool meets_box(const Vec3d& from, const Vec3d& inverse, const Node& node) {
  double enter = 0, leave = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(node.lower[axis]) - from[axis];
    const double above = static_cast<double>(node.upper[axis]) - from[axis];
    if (std::isinf(inverse[axis])) {
      if (below > 0 || above < 0) return false;
      continue;
    }
    const double a = below * inverse[axis], b = above * inverse[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

bool meets_triangle(const Vec3d& from, const Vec3d& line, const EdgedTriangle& t) {
  const Vec3d p = cross(line, t.ac);
  const double determinant = dot(t.ab, p);
  if (determinant == 0) return false;
  const Vec3d s = from - t.a;
  const double u = dot(s, p) / determinant;
  const Vec3d q = cross(s, t.ab);
  const double v = dot(line, q) / determinant;
  const double along = dot(t.ac, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along <= 1;
}

}  // namespace

EdgedTriangle edged_triangle(const Mesh& mesh, const Vec3d& offset, std::int64_t id) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
  const auto corner = [&](std::size_t k) { return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]); };
  // Edges are differences of floats, exact in double; they do not pass through the offset.
  return {offset + corner(0), corner(1) - corner(0), corner(2) - corner(0)};
}

BoxTree tree_of_triangles(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset) {
  exec::Buffer<Vec3f> centroids(ex.pool(), static_cast<std::int64_t>(mesh.triangles.size()));
  exec::for_each(ex, "tree", centroids.size(), [&](std::int64_t i) {
    const EdgedTriangle t = edged_triangle(mesh, Vec3d{0, 0, 0}, i);
    const Vec3d centroid = t.a + 1.0 / 3 * (t.ab + t.ac);
    centroids.data()[i] = {static_cast<float>(centroid[0]), static_cast<float>(centroid[1]),
                           static_cast<float>(centroid[2])};
  });
  return {ex, centroids.cview(), [&](std::int32_t id, BoxTree::Node& node) {
            for (const std::int32_t vertex : mesh.triangles[static_cast<std::size_t>(id)])
              include_point(offset + to_double(mesh.vertices[static_cast<std::size_t>(vertex)]), node);
          }};
}

TriangleTree::TriangleTree(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset)
    : tree_(tree_of_triangles(ex, mesh, offset)), triangles_(ex.pool(), tree_.size()) {
  exec::for_each(ex, "tree", tree_.size(),
                 [&](std::int64_t slot) { triangles_.data()[slot] = edged_triangle(mesh, offset, tree_.id(slot)); });
}

Nearest TriangleTree::nearest(const Vec3d& p, std::int32_t hint) const {
  const auto squared_distance_of = [&](std::int32_t slot) { return squared_distance(p, triangle(slot)); };
  return nearest_in(tree_, p, squared_distance_of, hint);
}

bool TriangleTree::is_between(const Vec3d& from, const Vec3d& to) const {
  const Vec3d line = to - from;
  const Vec3d inverse{1 / line[0], 1 / line[1], 1 / line[2]};
  std::array<std::int32_t, BoxTree::kMaxDepth>
      stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as it grows
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::int32_t at = stack[--height];
    const Node& node = tree_.nodes()[at];
    if (!meets_box(from, inverse, node)) continue;
    if (!node.is_leaf()) {
      stack[height++] = node.right;
      stack[height++] = at + 1;
      continue;
    }
    for (std::int32_t slot = node.first; slot < tree_.end_of_leaf(node); ++slot)
      if (meets_triangle(from, line, triangle(slot))) return true;
  }
  return false;
}

}  // namespace pointskin::mesh_detail
