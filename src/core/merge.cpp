#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/compact.hpp"

namespace pointskin {
namespace {

/// Moves the origin to `origin`; world positions stay, to float.
void rebase(Cloud& cloud, const Vec3d& origin) {
  const Vec3d move = cloud.origin - origin;
  for (Vec3f& p : cloud.positions)
    p = {static_cast<float>(p.x + move[0]), static_cast<float>(p.y + move[1]), static_cast<float>(p.z + move[2])};
  cloud.origin = origin;
}

/// Distance of the middle of a cloud from a place, times its points: what float positions around that place would lose.
double loss_around(const Cloud& cloud, const Vec3d& place) {
  const Bounds box = bounds_of(cloud.positions);
  const Vec3d lower = {box.lower.x, box.lower.y, box.lower.z};
  const Vec3d upper = {box.upper.x, box.upper.y, box.upper.z};
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

}  // namespace

void merge_into(Cloud& cloud, Cloud&& more) {
  more.dropped += cloud.dropped;
  cloud.dropped = more.dropped;
  if (more.positions.empty()) return;
  if (cloud.positions.empty()) {
    cloud = std::move(more);
    return;
  }
  if (cloud.origin != more.origin) {
    const auto loss = [&](const Vec3d& place) { return loss_around(cloud, place) + loss_around(more, place); };
    if (loss(more.origin) < loss(cloud.origin))
      rebase(cloud, more.origin);
    else
      rebase(more, cloud.origin);
  }
  const bool normals = cloud.has_normals() && more.has_normals();
  append_attributes(cloud.attributes, cloud.positions.size(), more.attributes, more.positions.size());
  append(cloud.positions, more.positions);
  append(cloud.normals, more.normals);
  if (!normals) cloud.normals.clear();
}

void keep_where(Cloud& cloud, const std::vector<bool>& keep) {
  if (keep.size() != cloud.positions.size())
    throw Error(ErrorCode::usage, std::to_string(keep.size()) + " marks of points to keep for " +
                                      std::to_string(cloud.positions.size()) + " points");
  cloud.dropped += std::count(keep.begin(), keep.end(), false);
  compact(cloud.positions, keep);
  compact(cloud.normals, keep);
  for (Attribute& attribute : cloud.attributes) attribute.values.keep_where(keep);
}

Cloud cloud_of_vertices(Mesh&& mesh) {
  return {mesh.origin, std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.attributes), 0};
}

}  // namespace pointskin
