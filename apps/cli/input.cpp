#include "input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "console.hpp"
#include "mesh_samples.hpp"
#include "probe.hpp"

namespace pointskin::cli {
namespace {

/// Moves the origin to `origin`; world positions stay, to float.
void rebase(Cloud& cloud, const Vec3d& origin) {
  const Vec3d move = {cloud.origin[0] - origin[0], cloud.origin[1] - origin[1], cloud.origin[2] - origin[2]};
  for (Vec3f& p : cloud.positions) {
    p = {static_cast<float>(p.x + move[0]), static_cast<float>(p.y + move[1]), static_cast<float>(p.z + move[2])};
  }
  cloud.origin = origin;
}

/// Distance of the middle of a cloud from a place, times its points: what float positions around that place would lose.
double loss_around(const Cloud& cloud, const Vec3d& place) {
  Vec3d lower, upper;
  lower.fill(std::numeric_limits<double>::infinity());
  upper.fill(-std::numeric_limits<double>::infinity());
  for (const Vec3f& p : cloud.positions) {
    const double at[3] = {p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      lower[a] = std::min(lower[a], at[a]);
      upper[a] = std::max(upper[a], at[a]);
    }
  }
  double farthest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    farthest = std::max(farthest, std::abs(cloud.origin[a] + (lower[a] + upper[a]) / 2 - place[a]));
  return farthest * static_cast<double>(cloud.size());
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Adds the attributes of `from_size` points behind those of `to_size`. Points without one of them lack its value.
void append_attributes(std::vector<Attribute>& to, std::size_t to_size, const std::vector<Attribute>& from,
                       std::size_t from_size) {
  const auto find_in = [](auto& attributes, const std::string& name) {
    return std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  };
  for (const Attribute& theirs : from)
    if (find_in(to, theirs.name) == to.end())
      to.push_back({theirs.name, AttributeValues::missing(theirs.type(), to_size)});
  for (Attribute& mine : to) {
    const auto theirs = find_in(from, mine.name);
    if (theirs == from.end())
      mine.values.resize(to_size + from_size);
    else
      mine.values.append(theirs->values);
  }
}

template <class T>
void keep_where(std::vector<T>& values, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i]) values[kept++] = values[i];
  }
  values.resize(kept);
}

Cloud vertices_as_cloud(Mesh&& mesh) {
  Cloud cloud;
  cloud.origin = mesh.origin;
  cloud.positions = std::move(mesh.vertices);
  cloud.normals = std::move(mesh.normals);
  cloud.attributes = std::move(mesh.attributes);
  return cloud;
}

}  // namespace

void append(Cloud& to, Cloud&& from) {
  if (to.origin != from.origin) {
    const auto loss = [&](const Vec3d& place) { return loss_around(to, place) + loss_around(from, place); };
    if (loss(from.origin) < loss(to.origin)) rebase(to, from.origin);
    if (to.origin != from.origin) rebase(from, to.origin);
  }
  const bool normals = to.has_normals() && from.has_normals();
  append_attributes(to.attributes, to.positions.size(), from.attributes, from.positions.size());
  append(to.positions, from.positions);
  append(to.normals, from.normals);
  if (!normals) to.normals.clear();
  to.dropped += from.dropped;
}

void check_not_empty(const Cloud& cloud, const std::string& name) {
  if (cloud.size() > 0) return;
  if (cloud.dropped == 0) throw Error(ErrorCode::empty_result, fmt::format("{}: holds no points", name));
  throw Error(ErrorCode::invalid_input,
              fmt::format("{}: none of its {} points has finite coordinates", name, cloud.dropped));
}

Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options, MissingNormals missing) {
  Cloud merged;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    Cloud cloud = read_cloud(paths[i], options);
    const std::string name = paths[i] == "-" ? "stdin" : paths[i];
    check_not_empty(cloud, name);
    if (missing == MissingNormals::refused && !cloud.has_normals() &&
        !read_vertices_of_mesh(paths[i], options, cloud)) {
      throw Error(
          ErrorCode::no_normals,
          fmt::format("{}: has no normals; it needs outward normals nx, ny, nz; 'pointskin orient' and reconstruct's "
                      "--estimate-normals make them",
                      name));
    }
    if (i == 0) {
      merged = std::move(cloud);
    } else {
      append(merged, std::move(cloud));
    }
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
  keep_where(cloud.positions, keep);
  keep_where(cloud.normals, keep);
  for (Attribute& attribute : cloud.attributes) attribute.values.keep_where(keep);
  cloud.dropped += zero;
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

bool keep_colours_only(Cloud& cloud) {
  std::erase_if(cloud.attributes, [](const Attribute& attribute) {
    return attribute.name != "red" && attribute.name != "green" && attribute.name != "blue";
  });
  return !cloud.attributes.empty();
}

std::variant<Cloud, Mesh> read_cloud_or_mesh(const std::string& path, const ReadOptions& options) {
  if (path == "-") make_stdin_seekable();
  if (!may_hold_faces(path)) return read_cloud(path, options);
  Mesh mesh = read_mesh(path, options);
  if (mesh.triangles.empty()) return vertices_as_cloud(std::move(mesh));
  return mesh;
}

}  // namespace pointskin::cli
