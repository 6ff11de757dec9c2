// Distance of a point from a triangle, on the host and in kernels.
// Source: Ericson, "Real-Time Collision Detection", 2005, 5.1.5 (the Voronoi regions of a triangle's features).
// Differs: inside the face the distance is that to the plane, which stays exact for needles, and triangles without a
// plane fall back to their three edges.
#pragma once

#include "core/vec3.hpp"

namespace pointskin {

/// A triangle as one corner and the two edges that leave it.
struct EdgedTriangle {
  Vec3d a, ab, ac;

  /// Twice the area, along the normal.
  [[nodiscard]] PSK_HD Vec3d area_vector() const { return cross(ab, ac); }
};

/// Squared distance of the point at `ap` from the segment from 0 to `ab`, which may have no length.
PSK_HD inline double squared_distance_to_segment(const Vec3d& ap, const Vec3d& ab) {
  const double along = dot(ap, ab);
  const double squared = squared_length(ab);
  const double t = along <= 0 ? 0 : along >= squared ? 1 : along / squared;
  return squared_length(ap - t * ab);
}

/// Below this squared sine of the angle at a, the normal is no better known than the triangle is wide.
inline constexpr double kNoPlane = 1e-16;

/// True if the triangle has a normal, which is `area_vector`.
PSK_HD inline bool has_plane(const EdgedTriangle& t, const Vec3d& area_vector) {
  return squared_length(area_vector) > kNoPlane * squared_length(t.ab) * squared_length(t.ac);
}

/// Squared distance of the point at `ap` (relative to corner a) from the border of `t`.
PSK_HD inline double squared_distance_to_border(const Vec3d& ap, const EdgedTriangle& t) {
  const double at_ab = squared_distance_to_segment(ap, t.ab);
  const double at_ac = squared_distance_to_segment(ap, t.ac);
  const double at_bc = squared_distance_to_segment(ap - t.ab, t.ac - t.ab);
  const double least = at_ab < at_ac ? at_ab : at_ac;
  return least < at_bc ? least : at_bc;
}

/// Squared distance of `p` from the nearest point of `t`. Exact up to rounding, for triangles without area too.
PSK_HD PSK_INTO_LOOP double squared_distance(const Vec3d& p, const EdgedTriangle& t) {
  const Vec3d ap = p - t.a;
  const double d1 = dot(t.ab, ap), d2 = dot(t.ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared_length(ap);
  const Vec3d bp = ap - t.ab;
  const double d3 = dot(t.ab, bp), d4 = dot(t.ac, bp);
  if (d3 >= 0 && d4 <= d3) return squared_length(bp);
  const Vec3d cp = ap - t.ac;
  const double d5 = dot(t.ab, cp), d6 = dot(t.ac, cp);
  if (d6 >= 0 && d5 <= d6) return squared_length(cp);

  const Vec3d n = t.area_vector();
  const double nn = squared_length(n);
  if (!has_plane(t, n)) return squared_distance_to_border(ap, t);
  if (d1 * d4 - d3 * d2 <= 0 && d1 >= 0 && d3 <= 0) return squared_length(ap - d1 / (d1 - d3) * t.ab);
  if (d5 * d2 - d1 * d6 <= 0 && d2 >= 0 && d6 <= 0) return squared_length(ap - d2 / (d2 - d6) * t.ac);
  if (d3 * d6 - d5 * d4 <= 0 && d4 >= d3 && d5 >= d6) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return squared_length(bp - s * (t.ac - t.ab));
  }
  const double height = dot(ap, n);
  return height * height / nn;
}

}  // namespace pointskin
