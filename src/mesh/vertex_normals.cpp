// The cross product of two edges of a triangle has twice its area for a length, so that plain sums are weighted by
// area. Source: Gouraud, "Continuous shading of curved surfaces", IEEE Transactions on Computers C-20, 1971 (the mean
// of the faces around a vertex). Differs: weighted by area.
#include <pointskin/vertex_normals.hpp>

#include <cstddef>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu.hpp"
#include "mesh/mesh_checks.hpp"

namespace pointskin {

void add_vertex_normals(Mesh& mesh) {
  exec::Cpu ex(1);
  mesh_detail::check_indices(ex, mesh);
  const auto at = [&mesh](std::int32_t v) { return to_double(mesh.vertices[static_cast<std::size_t>(v)]); };
  std::vector<Vec3d> sums(mesh.vertices.size(), Vec3d{0, 0, 0});
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = at(t[0]);
    const Vec3d face = cross(at(t[1]) - a, at(t[2]) - a);
    for (const std::int32_t v : t) {
      Vec3d& sum = sums[static_cast<std::size_t>(v)];
      sum += face;
    }
  }
  mesh.normals.resize(sums.size());
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const Vec3d n = normalized(sums[v]);
    mesh.normals[v] = {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
  }
}

}  // namespace pointskin
