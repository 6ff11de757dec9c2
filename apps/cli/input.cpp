#include "input.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/merge.hpp>

#include "console.hpp"
#include "standard_files.hpp"

namespace pointskin::cli {
Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options, MissingNormals missing) {
  std::vector<std::string> notices;
  Cloud merged = scene::read_clouds(paths, options, missing, notices);
  for (const std::string& notice : notices) print_warning(notice);
  return merged;
}

void warn_about_dropped(std::int64_t count, const std::string& prefix) {
  if (count > 0)
    print_warning(fmt::format("{}{} points were dropped: a coordinate is not finite, or beyond 1e38", prefix, count));
}

void warn_about_zero_normals(std::int64_t count, const std::string& prefix) {
  if (count > 0) print_warning(fmt::format("{}{} points were dropped: their normal has zero length", prefix, count));
}

void drop_unusable(Cloud& cloud, const std::string& prefix) {
  const std::int64_t not_finite = cloud.dropped;
  const std::int64_t no_normal = scene::drop_zero_normals(cloud);
  warn_about_dropped(not_finite, prefix);
  warn_about_zero_normals(no_normal, prefix);
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

void warn_about_no_colours() { print_warning("--colors: the points have no red, green or blue"); }

std::variant<Cloud, Mesh> read_cloud_or_mesh(const std::string& path, const ReadOptions& options) {
  if (path == "-") make_stdin_seekable();
  if (!may_hold_faces(path)) return read_cloud(path, options);
  Mesh mesh = read_mesh(path, options);
  if (mesh.triangles.empty()) return read_cloud(path, options);  // which counts the points that it leaves out
  return mesh;
}

}  // namespace pointskin::cli
