// Arithmetic on Vec3d for the mesh tools, which measure in double.
#pragma once

#include <pointskin/vector.hpp>

#include <cmath>

namespace pointskin::mesh_detail {

inline Vec3d to_double(const Vec3f& v) { return {v.x, v.y, v.z}; }
inline Vec3d plus(const Vec3d& a, const Vec3d& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3d times(double s, const Vec3d& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double squared_length(const Vec3d& a) { return dot(a, a); }
inline double length(const Vec3d& a) { return std::sqrt(squared_length(a)); }

/// `a` at unit length, or zero if `a` has no length.
inline Vec3d normalized(const Vec3d& a) {
  const double l = length(a);
  return l > 0 ? times(1 / l, a) : Vec3d{0, 0, 0};
}

}  // namespace pointskin::mesh_detail
