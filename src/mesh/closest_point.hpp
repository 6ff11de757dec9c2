// The point of a triangle that is nearest to a given one, and which of the triangle's features it lies on.
// Source: Ericson, "Real-Time Collision Detection", 2005, 5.1.5; regions as in core/triangle_distance.hpp.
#pragma once

#include <limits>

#include "core/triangle_distance.hpp"
#include "core/vec3.hpp"

namespace pointskin::mesh_detail {

/// Corner k, the edge from corner k to the next one, or the inside of the face.
struct Feature {
  enum Kind { face, edge, corner } kind = face;
  int index = 0;  ///< k of an edge or a corner
};

/// @see closest_point
struct ClosestPoint {
  Vec3d offset{};  ///< from the closest point to the given one
  Feature feature;
};

/// Closest point of the segment from 0 to `ab`, edge `index` of a triangle, to the point at `ap`.
inline ClosestPoint closest_on_edge(const Vec3d& ap, const Vec3d& ab, int index) {
  const double along = dot(ap, ab);
  const double squared = squared_length(ab);
  if (along <= 0) return {ap, {Feature::corner, index}};
  if (along >= squared) return {ap - ab, {Feature::corner, (index + 1) % 3}};
  return {ap - along / squared * ab, {Feature::edge, index}};
}

/// Closest point of the border of `t` to the point at `ap`, relative to corner 0.
inline ClosestPoint closest_on_border(const Vec3d& ap, const EdgedTriangle& t) {
  const ClosestPoint on_edges[3] = {closest_on_edge(ap, t.ab, 0), closest_on_edge(ap - t.ab, t.ac - t.ab, 1),
                                    closest_on_edge(ap - t.ac, -1 * t.ac, 2)};
  ClosestPoint best;
  double least = std::numeric_limits<double>::infinity();
  for (const ClosestPoint& candidate : on_edges) {
    const double d = squared_length(candidate.offset);
    if (d < least) best = candidate;
    if (d < least) least = d;
  }
  return best;
}

/// The point of `t` nearest to `p`, up to rounding; triangles without a plane have their three edges only.
inline ClosestPoint closest_point(const Vec3d& p, const EdgedTriangle& t) {
  const Vec3d ap = p - t.a;
  const Vec3d n = t.area_vector();
  if (!has_plane(t, n)) return closest_on_border(ap, t);
  const Vec3d bp = ap - t.ab, cp = ap - t.ac;
  // Above the inside of the face: on the inner side of all three edges.
  const bool above =
      dot(cross(t.ab, ap), n) > 0 && dot(cross(t.ac - t.ab, bp), n) > 0 && dot(cross(-1 * t.ac, cp), n) > 0;
  if (!above) return closest_on_border(ap, t);
  return {dot(ap, n) / squared_length(n) * n, {Feature::face, 0}};
}

}  // namespace pointskin::mesh_detail
