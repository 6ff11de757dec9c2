#include "mesh_samples.hpp"

#include <utility>

#include <fmt/format.h>

#include <pointskin/formats.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/vertex_normals.hpp>

#include "console.hpp"

namespace pointskin::cli {

bool read_vertices_of_mesh(const std::string& path, const ReadOptions& options, Cloud& cloud) {
  if (path == "-" || !may_hold_faces(path)) return false;
  Mesh mesh = read_mesh(path, options);
  if (mesh.triangles.empty()) return false;
  print_warning(
      fmt::format("{}: its vertices have no normals and take those of the faces around them ({} vertices, {} "
                  "triangles)",
                  path, mesh.vertices.size(), mesh.triangles.size()));
  add_vertex_normals(mesh);
  cloud = cloud_of_vertices(std::move(mesh));
  return true;
}

}  // namespace pointskin::cli
