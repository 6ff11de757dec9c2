#include "mesh/signed_distance.hpp"

#include <algorithm>
#include <cmath>

#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {

SignedDistance::SignedDistance(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset)
    : mesh_(mesh),
      tree_(ex, mesh, offset),
      face_normals_(ex.pool(), static_cast<std::int64_t>(mesh.triangles.size())),
      neighbours_(ex.pool(), 3 * face_normals_.size()),
      corner_normals_(ex.pool(), static_cast<std::int64_t>(mesh.vertices.size())) {
  exec::for_each(ex, "normals", face_normals_.size(), [&](std::int64_t t) {
    const EdgedTriangle triangle = edged_triangle(mesh_, Vec3d{0, 0, 0}, t);
    const Vec3d n = triangle.area_vector();
    face_normals_.data()[t] = has_plane(triangle, n) ? 1 / length(n) * n : Vec3d{0, 0, 0};
  });
  find_neighbours(ex);
  sum_corner_normals();
}

void SignedDistance::find_neighbours(exec::Cpu& ex) {
  const std::int64_t sides = neighbours_.size();
  exec::Buffer<std::uint64_t> edges(ex.pool(), sides);
  exec::Buffer<std::int32_t> order = exec::iota(ex, sides);
  exec::for_each(ex, "edges", sides, [&](std::int64_t i) {
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(i / 3)];
    const auto k = static_cast<std::size_t>(i % 3);
    const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
    edges.data()[i] = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
  });
  sort_pairs(ex, "edges", edges, order, 64);
  exec::for_each(ex, "edges", sides / 2, [&](std::int64_t i) {  // every edge has two triangles
    const std::int32_t a = order.data()[2 * i], b = order.data()[2 * i + 1];
    neighbours_.data()[a] = b / 3;
    neighbours_.data()[b] = a / 3;
  });
}

void SignedDistance::sum_corner_normals() {
  std::fill_n(corner_normals_.data(), corner_normals_.size(), Vec3d{0, 0, 0});
  for (std::int64_t i = 0; i < face_normals_.size(); ++i) {
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = [&](std::size_t c) { return to_double(mesh_.vertices[static_cast<std::size_t>(t[c % 3])]); };
      const Vec3d a = corner(k + 1) - corner(k), b = corner(k + 2) - corner(k);
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      Vec3d& sum = corner_normals_.data()[t[k]];
      sum += angle * face_normals_.data()[i];
    }
  }
}

Vec3d SignedDistance::pseudonormal(std::int32_t triangle, const Feature& feature) const {
  const Vec3d& own = face_normals_.data()[triangle];
  if (feature.kind == Feature::face) return own;
  const Triangle& t = mesh_.triangles[static_cast<std::size_t>(triangle)];
  const auto k = static_cast<std::size_t>(feature.index);
  const Vec3d& corner = corner_normals_.data()[t[k]];
  if (feature.kind == Feature::corner) return corner;
  const Vec3d both = own + face_normals_.data()[neighbours_.data()[3 * std::int64_t{triangle} + feature.index]];
  if (squared_length(both) > 0) return both;
  return corner + corner_normals_.data()[t[(k + 1) % 3]];  // neither triangle has a plane
}

SurfacePlace SignedDistance::at(const Vec3d& p, std::int32_t hint) const {
  const Nearest nearest = tree_.nearest(p, hint);
  const ClosestPoint closest = closest_point(p, tree_.triangle(nearest.slot));
  const bool outside = dot(closest.offset, pseudonormal(tree_.id(nearest.slot), closest.feature)) > 0;
  const double distance = length(closest.offset);
  return {outside ? -distance : distance, p - closest.offset, nearest.slot};
}

}  // namespace pointskin::mesh_detail
