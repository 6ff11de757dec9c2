// Foot points: Newton's method for the nearest point subject to F = 0, in the tangent plane, each step followed by a
// projection onto the surface. Source: Absil, Mahony & Sepulchre, "Optimization algorithms on matrix manifolds", 2008,
// ch. 4 and 6 (retraction, line search).
#include "closest_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

constexpr double kOnSurface = 1e-11;  // first-order distance of a point that counts as one of the surface

/// The projection of `q`, or nothing where Newton's steps did not end on the surface.
std::optional<SurfacePoint> project_if_possible(const Shape& shape, const Vec3d& q) {
  const SurfacePoint point = project(shape, q, shape.at(q));
  if (!(std::abs(signed_distance(shape, point.position)) < kOnSurface)) return std::nullopt;
  return point;
}

/// Moves `at` along the surface in the direction of `along`, nearer to `q`. @returns false if no step is nearer
bool step_nearer(const Shape& shape, const Vec3d& q, const Vec3d& along, SurfacePoint& at) {
  const double squared = squared_length(q - at.position);
  for (double length = 1; length > 1e-4; length /= 2) {
    const auto next = project_if_possible(shape, at.position + length * along);
    if (!next || !(squared_length(q - next->position) < squared)) continue;
    at = *next;
    return true;
  }
  return false;
}

/// Two unit vectors orthogonal to `normal` and to each other.
std::array<Vec3d, 2> tangents(const Vec3d& normal) {
  const Vec3d aside = std::abs(normal[0]) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(cross(normal, aside));
  return {u, cross(normal, u)};
}

/// The part of `d` along the surface, and Newton's step towards the foot point where the squared distance is convex.
///
/// With the multiplier m = d . grad F / |grad F|^2 the Hessian of |x - q|^2 / 2 + m F is I + m D^2 F; only its part in
/// the tangent plane matters. D^2 F comes from central differences of the gradient.
Vec3d newton_step(const Shape& shape, const SurfacePoint& at, const Vec3d& d, const Vec3d& along) {
  constexpr double kStep = 1e-5;
  constexpr double kLongest = 0.1;  // a step that is no longer than parts of the shapes
  const Vec3d gradient = shape.at(at.position).gradient;
  const double multiplier = dot(d, gradient) / squared_length(gradient);
  const auto [u, v] = tangents(at.normal);
  const auto curved = [&](const Vec3d& t) {
    return multiplier / (2 * kStep) *
           (shape.at(at.position + kStep * t).gradient - shape.at(at.position - kStep * t).gradient);
  };
  const Vec3d cu = curved(u), cv = curved(v);
  const double uu = 1 + dot(u, cu), vv = 1 + dot(v, cv), uv = (dot(u, cv) + dot(v, cu)) / 2;
  const double det = uu * vv - uv * uv, du = dot(u, d), dv = dot(v, d);
  if (!(det > 1e-9 && uu + vv > 0)) return along;
  const Vec3d step = (vv * du - uv * dv) / det * u + (uu * dv - uv * du) / det * v;
  return std::min(1.0, kLongest / length(step)) * step;
}

/// Descends from `at` until q - at has no part along the surface.
SurfacePoint descend(const Shape& shape, const Vec3d& q, SurfacePoint at) {
  for (int step = 0; step < 100; ++step) {
    const Vec3d d = q - at.position;
    const Vec3d along = d - dot(d, at.normal) * at.normal;
    // The distance is wrong by the square of this part over the distance.
    if (squared_length(along) <= 1e-10 * squared_length(d) || squared_length(along) < 1e-22) break;
    if (!step_nearer(shape, q, newton_step(shape, at, d, along), at) && !step_nearer(shape, q, along, at)) break;
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
  if (straight && squared_length(q - straight->position) <= nearest.squared_distance)
    return descend(shape_, q, *straight);
  const Vec3d seed = tree_->triangle(nearest.slot).a;
  return descend(shape_, q, project(shape_, seed, shape_.at(seed)));
}

}  // namespace pointskin::bench
