// Flat cylinders around triangles, which stay thin where these lie askew, on every device.
#pragma once

#include <pointskin/cloud.hpp>

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/triangle_distance.hpp"
#include "core/vec3.hpp"
#include "octree/bounding_box.hpp"

namespace pointskin::field::offset {

/// The corners of a triangle.
struct PlacedTriangle {
  Vec3f a, b, c;

  /// Squared distance from q. In double: the triangles are small.
  [[nodiscard]] PSK_HD double squared_distance(const Vec3f& q) const {
    const Vec3d at = to_double(a);
    return pointskin::squared_distance(to_double(q), {at, to_double(b) - at, to_double(c) - at});
  }
};

PSK_HD inline Bounds box_of(const PlacedTriangle& t) {
  const octree::JoinBoxes join;
  return join(join({t.a, t.a}, {t.b, t.b}), {t.c, t.c});
}

/// A flat cylinder. Around triangles that lie askew a box is as thick as it is wide, and hundreds of them seem to be as
/// near as the nearest one; a disc stays as thin as they are.
struct BoundingDisc {
  Vec3f centre;
  float radius = 0;
  Vec3f normal;  ///< unit length
  float half_thickness = 0;

  /// At most the squared distance from q to what is inside, times 1 + 1e-6.
  [[nodiscard]] PSK_HD float squared_distance(const Vec3f& q) const {
    const Vec3f d = q - centre;
    const float along = dot(d, normal);
    const Vec3f across = d - along * normal;
    const float above = std::abs(along) - half_thickness;
    const float beside = std::sqrt(dot(across, across)) - radius;
    return (above > 0 ? above * above : 0.0F) + (beside > 0 ? beside * beside : 0.0F);
  }
};

/// Calls visit(corner) for the corners of triangles [begin, end).
template <class Visit>
PSK_HD void for_corners(ArrayView<const PlacedTriangle> triangles, std::int64_t begin, std::int64_t end,
                        const Visit& visit) {
  for (std::int64_t i = begin; i < end; ++i) {
    visit(triangles[i].a);
    visit(triangles[i].b);
    visit(triangles[i].c);
  }
}

/// The disc around triangles [begin, end), at least one: across their mean normal, around the middle of their box.
PSK_HD inline BoundingDisc disc_around(ArrayView<const PlacedTriangle> triangles, std::int64_t begin,
                                       std::int64_t end) {
  Vec3d area{0, 0, 0};
  Bounds box = box_of(triangles[begin]);
  for (std::int64_t i = begin; i < end; ++i) {
    const Vec3d a = to_double(triangles[i].a);
    area += cross(to_double(triangles[i].b) - a, to_double(triangles[i].c) - a);
    box = octree::JoinBoxes{}(box, box_of(triangles[i]));
  }
  const double length = std::sqrt(squared_length(area));
  BoundingDisc disc;
  disc.normal = length > 0 ? to_float(1 / length * area) : Vec3f{0, 0, 1};
  const Vec3d normal = to_double(disc.normal);
  const Vec3d middle = 0.5 * (to_double(box.lower) + to_double(box.upper));
  double lowest = dot(to_double(triangles[begin].a) - middle, normal), highest = lowest;
  for_corners(triangles, begin, end, [&](const Vec3f& corner) {
    const double along = dot(to_double(corner) - middle, normal);
    lowest = along < lowest ? along : lowest;
    highest = along > highest ? along : highest;
  });
  disc.centre = to_float(middle + 0.5 * (lowest + highest) * normal);
  const Vec3d centre = to_double(disc.centre);
  double thickness = 0, squared_radius = 0;
  for_corners(triangles, begin, end, [&](const Vec3f& corner) {
    const Vec3d d = to_double(corner) - centre;
    const double along = dot(d, normal);
    const double across = squared_length(d - along * normal);
    thickness = std::abs(along) > thickness ? std::abs(along) : thickness;
    squared_radius = across > squared_radius ? across : squared_radius;
  });
  // What rounding takes from either where distances are measured.
  const double radius = std::sqrt(squared_radius);
  const double rounding = 1e-6 * (radius + thickness);
  disc.radius = static_cast<float>(radius + rounding);
  disc.half_thickness = static_cast<float>(thickness + rounding);
  return disc;
}

}  // namespace pointskin::field::offset
