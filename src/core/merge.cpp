#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include "core/compact.hpp"
#include "core/rebase.hpp"

namespace pointskin {
namespace {

void rebase(Cloud& cloud, const Vec3d& origin) {
  const Vec3d move = cloud.origin - origin;
  for (Vec3f& p : cloud.positions) p = rebased(p, move);
  cloud.origin = origin;
}

PointsAround around(const Cloud& cloud) { return {cloud.origin, bounds_of(cloud.positions), cloud.size()}; }

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
    if (around(cloud).takes_origin_of(around(more)))
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
