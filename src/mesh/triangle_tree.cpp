#include "mesh/triangle_tree.hpp"

namespace pointskin::mesh_detail {

EdgedTriangle edged_triangle(const Mesh& mesh, const Vec3d& offset, std::int64_t id) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
  const auto corner = [&](std::size_t k) { return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]); };
  // Edges are differences of floats, exact in double; they do not pass through the offset.
  return {plus(offset, corner(0)), minus(corner(1), corner(0)), minus(corner(2), corner(0))};
}

BoxTree tree_of_triangles(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset) {
  exec::Buffer<Vec3f> centroids(ex.pool(), static_cast<std::int64_t>(mesh.triangles.size()));
  exec::for_each(ex, "tree", centroids.size(), [&](std::int64_t i) {
    const EdgedTriangle t = edged_triangle(mesh, Vec3d{0, 0, 0}, i);
    const Vec3d centroid = plus(t.a, times(1.0 / 3, plus(t.ab, t.ac)));
    centroids.data()[i] = {static_cast<float>(centroid[0]), static_cast<float>(centroid[1]),
                           static_cast<float>(centroid[2])};
  });
  return {ex, centroids.cview(), [&](std::int32_t id, BoxTree::Node& node) {
            for (const std::int32_t vertex : mesh.triangles[static_cast<std::size_t>(id)])
              include_point(plus(offset, to_double(mesh.vertices[static_cast<std::size_t>(vertex)])), node);
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

}  // namespace pointskin::mesh_detail
