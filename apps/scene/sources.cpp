#include "scene/sources.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/vertex_normals.hpp>

#include "scene/source_json.hpp"
#include "shapes.hpp"

namespace pointskin::scene {
namespace {

/// Reads the mesh file `path`, whose vertices have no normals, as a cloud of its vertices with the normals of the faces
/// around them (add_vertex_normals), and says so in a notice. Vertices without faces get zero normals.
/// @param cloud  receives the vertices, or stays as it was
/// @returns false for files that hold no faces, and for stdin, which cannot be read a second time
/// @throws Error as read_mesh
bool read_vertices_of_mesh(const std::string& path, const ReadOptions& options, Cloud& cloud,
                           std::vector<std::string>& notices) {
  if (path == "-" || !may_hold_faces(path)) return false;
  Mesh mesh = read_mesh(path, options);
  if (mesh.triangles.empty()) return false;
  notices.push_back(
      fmt::format("{}: its vertices have no normals and take those of the faces around them ({} vertices, {} "
                  "triangles)",
                  path, mesh.vertices.size(), mesh.triangles.size()));
  add_vertex_normals(mesh);
  cloud = cloud_of_vertices(std::move(mesh));
  return true;
}

Cloud read_one(const std::string& path, const ReadOptions& options, MissingNormals missing,
               std::vector<std::string>& notices) {
  Cloud cloud = read_cloud(path, options);
  const std::string name = path == "-" ? "stdin" : path;
  check_not_empty(cloud, name);
  if (missing == MissingNormals::refused && !cloud.has_normals() &&
      !read_vertices_of_mesh(path, options, cloud, notices)) {
    throw Error(
        ErrorCode::no_normals,
        fmt::format("{}: has no normals; it needs outward normals nx, ny, nz; 'pointskin orient' and reconstruct's "
                    "--estimate-normals make them",
                    name));
  }
  return cloud;
}

/// What tells a solid from all others, and from itself before its file was changed.
std::string key_of(const SolidSource& source) {
  if (source.file.empty()) return source_text(source);
  std::error_code failed;
  const auto bytes = std::filesystem::file_size(source.file, failed);
  const auto time = std::filesystem::last_write_time(source.file, failed);
  return fmt::format("{} {} {}", source.file, bytes, time.time_since_epoch().count());
}

Solid read_solid(const SolidSource& source, const ReadOptions& options) {
  if (source.file.empty()) return shape_cloud(source.shape, source.points);
  if (may_hold_faces(source.file)) {
    Mesh mesh = read_mesh(source.file, options);
    if (!mesh.triangles.empty()) return mesh;
  }
  Cloud cloud = read_cloud(source.file, options);
  check_not_empty(cloud, source.file);
  if (!cloud.has_normals())
    throw Error(ErrorCode::no_normals,
                fmt::format("{}: has no normals; it needs outward normals nx, ny, nz", source.file));
  drop_zero_normals(cloud);
  cloud.attributes.clear();
  return cloud;
}

/// What is kept under `key`, or what `read` makes now; the oldest of too many is forgotten.
template <class T, class Read>
std::shared_ptr<const T> kept(std::deque<std::pair<std::string, std::shared_ptr<const T>>>& all, const std::string& key,
                              const Read& read) {
  for (const auto& [name, value] : all)
    if (name == key) return value;
  all.emplace_front(key, std::make_shared<const T>(read()));
  if (all.size() > Sources::kKept) all.pop_back();
  return all.front().second;
}

}  // namespace

CloudSource cloud_of_file(const std::string& path) {
  CloudSource cloud;
  cloud.file = std::filesystem::absolute(path).lexically_normal().string();
  return cloud;
}

void check_not_empty(const Cloud& cloud, const std::string& name) {
  if (cloud.size() > 0) return;
  if (cloud.dropped == 0) throw Error(ErrorCode::empty_result, fmt::format("{}: holds no points", name));
  throw Error(ErrorCode::invalid_input,
              fmt::format("{}: none of its {} points has finite coordinates of at most 1e38", name, cloud.dropped));
}

Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options, MissingNormals missing,
                  std::vector<std::string>& notices) {
  Cloud merged;
  for (const std::string& path : paths) merge_into(merged, read_one(path, options, missing, notices));
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

Cloud merge_sources(const std::vector<CloudSource>& sources, const ReadOptions& options, MissingNormals missing,
                    ReadFacts& facts) {
  Cloud merged;
  for (const CloudSource& source : sources) {
    if (source.file.empty())
      merge_into(merged, shape_cloud(source.shape, source.points));
    else
      merge_into(merged, read_one(source.file, options, missing, facts.notices));
  }
  facts.not_finite = merged.dropped;
  return merged;
}

Cloud load_base(const std::vector<CloudSource>& sources, const ReadOptions& options, MissingNormals missing,
                ReadFacts& facts) {
  Cloud merged = merge_sources(sources, options, missing, facts);
  if (merged.has_normals()) facts.no_normal = drop_zero_normals(merged);
  return merged;
}

Cloud shape_cloud(const std::string& name, std::int64_t points) {
  return bench::sample_surface(*bench::make_shape(name), {.points = points, .seed = 1});
}

std::shared_ptr<const Solid> Sources::solid(const SolidSource& source) {
  return kept(solids_, key_of(source), [&] { return read_solid(source, {.threads = threads_}); });
}

std::shared_ptr<const Cloud> Sources::part(const SolidSource& source) {
  return kept(parts_, key_of(source), [&] {
    return source.file.empty() ? shape_cloud(source.shape, source.points)
                               : read_cloud(source.file, {.threads = threads_});
  });
}

}  // namespace pointskin::scene
