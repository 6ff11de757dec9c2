#include "input.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/vertex_normals.hpp>

#include "console.hpp"
#include "standard_files.hpp"

namespace pointskin::cli {
namespace {

/// Reads the mesh file `path`, whose vertices have no normals, as a cloud of its vertices with the normals of the faces
/// around them (add_vertex_normals), and says so in a warning. Vertices without faces get zero normals.
/// @param cloud  receives the vertices, or stays as it was
/// @returns false for files that hold no faces, and for stdin, which cannot be read a second time
/// @throws Error as read_mesh
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

}  // namespace

void check_not_empty(const Cloud& cloud, const std::string& name) {
  if (cloud.size() > 0) return;
  if (cloud.dropped == 0) throw Error(ErrorCode::empty_result, fmt::format("{}: holds no points", name));
  throw Error(ErrorCode::invalid_input,
              fmt::format("{}: none of its {} points has finite coordinates", name, cloud.dropped));
}

Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options, MissingNormals missing) {
  Cloud merged;
  for (const std::string& path : paths) {
    Cloud cloud = read_cloud(path, options);
    const std::string name = path == "-" ? "stdin" : path;
    check_not_empty(cloud, name);
    if (missing == MissingNormals::refused && !cloud.has_normals() && !read_vertices_of_mesh(path, options, cloud)) {
      throw Error(
          ErrorCode::no_normals,
          fmt::format("{}: has no normals; it needs outward normals nx, ny, nz; 'pointskin orient' and reconstruct's "
                      "--estimate-normals make them",
                      name));
    }
    merge_into(merged, std::move(cloud));
  }
  return merged;
}

std::int64_t drop_zero_normals(Cloud& cloud) {
  const std::int64_t zero = std::count(cloud.normals.begin(), cloud.normals.end(), Vec3f{});
  if (zero == cloud.size()) {
    throw Error(ErrorCode::no_normals,
                fmt::format("the normals of all {} points have zero length; outward normals are needed", zero));
  }
  if (zero == 0) return 0;
  std::vector<bool> keep(cloud.normals.size());
  std::transform(cloud.normals.begin(), cloud.normals.end(), keep.begin(), [](const Vec3f& n) { return n != Vec3f{}; });
  keep_where(cloud, keep);
  return zero;
}

void warn_about_dropped(std::int64_t count, const std::string& prefix) {
  if (count > 0) print_warning(fmt::format("{}{} points were dropped: a coordinate is not finite", prefix, count));
}

void drop_unusable(Cloud& cloud, const std::string& prefix) {
  const std::int64_t not_finite = cloud.dropped;
  const std::int64_t no_normal = drop_zero_normals(cloud);
  warn_about_dropped(not_finite, prefix);
  if (no_normal > 0)
    print_warning(fmt::format("{}{} points were dropped: their normal has zero length", prefix, no_normal));
}

std::shared_ptr<const Mesh> read_envelope(const std::string& path, int threads) {
  if (path.empty()) return nullptr;
  Mesh mesh = read_mesh(path, {.shift = std::nullopt, .threads = threads});
  if (mesh.triangles.empty())
    throw Error(ErrorCode::invalid_input, path + ": has no triangles; the envelope must be a closed mesh");
  return std::make_shared<const Mesh>(std::move(mesh));
}

std::string strays_text(std::int64_t count, const Vec3d& farthest) {
  return fmt::format(
      "{} stray points far from all others are left out, the farthest at {:.9g} {:.9g} {:.9g}; use "
      "--keep-strays to keep them",
      count, farthest[0], farthest[1], farthest[2]);
}

void warn_about_strays(const Cloud& cloud, int threads) {
  const Strays strays = find_strays(cloud.positions, threads);
  if (strays.points.empty()) return;
  const Vec3f& p = cloud.positions[static_cast<std::size_t>(strays.points.front())];
  const Vec3d& origin = cloud.origin;
  print_warning(strays_text(static_cast<std::int64_t>(strays.points.size()),
                            {origin[0] + p.x, origin[1] + p.y, origin[2] + p.z}));
}

bool is_colour(const Attribute& attribute) {
  return attribute.name == "red" || attribute.name == "green" || attribute.name == "blue";
}

bool keep_colours_only(Cloud& cloud) {
  std::erase_if(cloud.attributes, [](const Attribute& attribute) { return !is_colour(attribute); });
  return !cloud.attributes.empty();
}

std::variant<Cloud, Mesh> read_cloud_or_mesh(const std::string& path, const ReadOptions& options) {
  if (path == "-") make_stdin_seekable();
  if (!may_hold_faces(path)) return read_cloud(path, options);
  Mesh mesh = read_mesh(path, options);
  if (mesh.triangles.empty()) return cloud_of_vertices(std::move(mesh));
  return mesh;
}

}  // namespace pointskin::cli
