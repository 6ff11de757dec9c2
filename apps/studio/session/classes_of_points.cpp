#include "classes_of_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <pointskin/vector.hpp>

namespace pointskin::studio {
namespace {

Vec3d world(const Cloud& cloud, std::size_t i) {
  const Vec3f& p = cloud.positions[i];
  return {cloud.origin.x + double{p.x}, cloud.origin.y + double{p.y}, cloud.origin.z + double{p.z}};
}

/// What float keeps of a coordinate: 2^-22 of the largest one.
double rounding_of(const Cloud& cloud) {
  const Bounds box = bounds_of(cloud.positions);
  const auto largest = [](const Vec3f& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  return 0x1p-22 * double{std::max(largest(box.lower), largest(box.upper))};
}

bool is_same_place(const Vec3d& a, const Vec3d& b, double rounding) {
  return std::abs(a.x - b.x) <= rounding && std::abs(a.y - b.y) <= rounding && std::abs(a.z - b.z) <= rounding;
}

}  // namespace

ClassedPoints classes_of_points(const std::vector<const Cloud*>& parts, const Cloud& kept) {
  ClassedPoints result;
  result.points.origin = kept.origin;
  std::size_t next = 0;
  for (const Cloud* part : parts) {
    const double rounding = std::max(rounding_of(*part), rounding_of(kept));
    for (std::size_t i = 0; i < part->positions.size(); ++i) {
      const Vec3d place = world(*part, i);
      PointClass what = kDropped;
      if (next < kept.positions.size() && is_same_place(place, world(kept, next), rounding)) {
        what = dot(part->normals[i], kept.normals[next]) < 0 ? kFlipped : kKept;
        ++next;
      }
      const Vec3d relative = place - kept.origin;
      result.points.positions.push_back(
          {static_cast<float>(relative.x), static_cast<float>(relative.y), static_cast<float>(relative.z)});
      result.points.normals.push_back(part->normals[i]);
      result.classes.push_back(what);
    }
  }
  return result;
}

}  // namespace pointskin::studio
