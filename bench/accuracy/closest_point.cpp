// Source: Hartmann, "On the curvature of curves and surfaces defined by normalforms", CAGD 16, 1999 (foot points:
// tangential steps, each followed by a projection onto the surface).
// Differs: steps are halved until the distance falls, so that points beyond a centre of curvature converge too.
#include "closest_point.hpp"

#include <cmath>

#include "mesh/vec3d.hpp"

namespace pointskin::bench {
namespace {

using mesh_detail::dot;
using mesh_detail::minus;
using mesh_detail::plus;
using mesh_detail::squared_length;
using mesh_detail::times;

constexpr double kOnSurface = 1e-11;  // first-order distance of a point that counts as one of the surface

/// The projection of `q`, or nothing where Newton's steps did not end on the surface.
std::optional<SurfacePoint> project_if_possible(const Shape& shape, const Vec3d& q) {
  const SurfacePoint point = project(shape, q, shape.at(q));
  if (!(std::abs(signed_distance(shape, point.position)) < kOnSurface)) return std::nullopt;
  return point;
}

/// Moves `at` along the surface, nearer to `q`. @returns false if no step does
bool step_nearer(const Shape& shape, const Vec3d& q, const Vec3d& along, SurfacePoint& at) {
  const double squared = squared_length(minus(q, at.position));
  for (double length = 1; length > 1e-3; length /= 2) {
    const auto next = project_if_possible(shape, plus(at.position, times(length, along)));
    if (!next || !(squared_length(minus(q, next->position)) < squared)) continue;
    at = *next;
    return true;
  }
  return false;
}

/// Descends from `at` until q - at has no part along the surface.
SurfacePoint descend(const Shape& shape, const Vec3d& q, SurfacePoint at) {
  for (int step = 0; step < 100; ++step) {
    const Vec3d d = minus(q, at.position);
    const Vec3d along = minus(d, times(dot(d, at.normal), at.normal));
    // The distance is wrong by the square of this part over the distance.
    if (squared_length(along) <= 1e-10 * squared_length(d) || squared_length(along) < 1e-22) break;
    if (!step_nearer(shape, q, along, at)) break;
  }
  return at;
}

}  // namespace

ClosestPoint::ClosestPoint(exec::Cpu& ex, const Shape& shape, std::int64_t seeds) : shape_(shape) {
  if (shape.is_distance()) return;
  seeds_.vertices = sample_surface(shape, {.points = seeds, .seed = 0xc105e57, .threads = ex.threads()}).positions;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(seeds); ++i) seeds_.triangles.push_back({i, i, i});
  tree_.emplace(ex, seeds_, Vec3d{0, 0, 0});
}

SurfacePoint ClosestPoint::operator()(const Vec3d& q) const {
  if (!tree_) return shape_.closest(q);
  const mesh_detail::Nearest nearest = tree_->nearest(q);
  const auto straight = project_if_possible(shape_, q);
  if (straight && squared_length(minus(q, straight->position)) <= nearest.squared_distance)
    return descend(shape_, q, *straight);
  const Vec3d seed = tree_->triangle(nearest.slot).a;
  return descend(shape_, q, project(shape_, seed, shape_.at(seed)));
}

}  // namespace pointskin::bench
