#include "render/view_axes.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3.hpp"

namespace pointskin::render_detail {
namespace {

/// A direction given with y up, x to the right and the front at +z, for `up`.
Vec3d turned(const Vec3d& v, UpAxis up) {
  switch (up) {
    case UpAxis::y:
      return v;
    case UpAxis::z:
      return {v[0], -v[2], v[1]};
    case UpAxis::x:
      return {v[1], -v[0], v[2]};
    case UpAxis::minus_x:
      return {-v[1], v[0], v[2]};
    case UpAxis::minus_y:
      return {v[0], -v[1], -v[2]};
    case UpAxis::minus_z:
      return {v[0], v[2], -v[1]};
  }
  return v;
}

}  // namespace

ViewAxes view_axes(UpAxis up, double azimuth, double elevation) {
  ViewAxes axes;
  axes.back = turned(
      {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)}, up);
  axes.right = turned({std::cos(azimuth), 0, -std::sin(azimuth)}, up);
  axes.up = cross(axes.back, axes.right);
  return axes;
}

Vec3d up_direction(UpAxis up) { return turned({0, 1, 0}, up); }

ViewAngles view_angles(UpAxis up, const Vec3d& back) {
  const double x = dot(turned({1, 0, 0}, up), back);
  const double y = dot(turned({0, 1, 0}, up), back);
  const double z = dot(turned({0, 0, 1}, up), back);
  return {std::atan2(x, z), std::asin(std::clamp(y, -1.0, 1.0))};
}

}  // namespace pointskin::render_detail
