#include "render/camera.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/colour_bar.hpp"
#include "render/fit_box.hpp"

namespace pointskin::render_detail {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Half the angle under which the viewer sees kRenderFill of the picture's shorter side, unless told otherwise.
constexpr double kHalfAngle = 14 * kDegree;

/// Pixels per unit at unit depth.
double focal_pixels(const RenderOptions& options) {
  if (options.field_of_view_degrees)
    return options.height / 2.0 / std::tan(*options.field_of_view_degrees * kDegree / 2);
  return kRenderFill * std::min(options.width, options.height) / 2 / std::tan(kHalfAngle);
}

}  // namespace

Viewport viewport_of(const RenderOptions& options) {
  return {static_cast<double>(options.width - colour_bar_width(options)), static_cast<double>(options.height)};
}

Camera::Camera(exec::Cpu& ex, const FitPoints& points, const Vec3d& origin, const RenderOptions& options)
    : origin_(origin),
      centre_(options.target_world ? *options.target_world - origin : points.centre(ex)),
      perspective_(options.projection == Projection::perspective) {
  orient(options);
  const double radius = points.radius_about(ex, centre_);
  if (radius > 0) radius_ = radius;
  const Viewport viewport = viewport_of(options);
  if (options.fit == Fit::sphere) {
    fit_sphere(viewport, options);
  } else {
    fit_box(ex, points, viewport, options);
  }
  choose_steps(viewport, options);
}

void Camera::orient(const RenderOptions& options) {
  axes_ = view_axes(options.up, options.azimuth_degrees * kDegree, options.elevation_degrees * kDegree);
  up_in_view_ = to_view(up_direction(options.up));
}

void Camera::fit_sphere(const Viewport& viewport, const RenderOptions& options) {
  const double radius_pixels = kRenderFill * std::min(viewport.width, viewport.height) / 2;
  focal_pixels_ = perspective_ ? focal_pixels(options) : radius_pixels;
  // A sphere's outline is the cone that touches it: sin(half angle) = radius / distance.
  const bool usual = !options.field_of_view_degrees && viewport.width == options.width;
  distance_ = 1 / std::sin(usual ? kHalfAngle : std::atan(radius_pixels / focal_pixels(options)));
}

void Camera::fit_box(exec::Cpu& ex, const FitPoints& points, const Viewport& viewport, const RenderOptions& options) {
  const ViewSpace space{axes_, centre_, radius_};
  const double focal = focal_pixels(options);
  const HalfExtent pixels{kRenderFill * viewport.width / 2, kRenderFill * viewport.height / 2};
  const bool centred = !options.target_world;
  FittedView view;
  if (perspective_) {
    view = fit_perspective(ex, points, space, {pixels.x / focal, pixels.y / focal}, centred);
    distance_ = view.distance;
    focal_pixels_ = focal;
  } else {
    view = fit_orthographic(ex, points, space, pixels, centred);
    distance_ = 1 / std::sin(kHalfAngle);
    focal_pixels_ = view.per_radius;
  }
  centre_ += radius_ * (view.x * axes_.right + view.y * axes_.up);
}

void Camera::choose_steps(const Viewport& viewport, const RenderOptions& options) {
  focal_pixels_ *= options.zoom;
  // What is fitted reaches from one side of the picture to the other, times the zoom; 2^29 steps leave the products of
  // differences of coordinates within 64 bits.
  constexpr int kMostBits = 29, kLeastBits = 5;
  const double pixels = std::max(options.width, options.height) * std::max(1.0, options.zoom);
  step_bits_ = std::clamp(kMostBits - static_cast<int>(std::ceil(std::log2(pixels))), kLeastBits, kMostStepBits);
  const double steps = 1 << step_bits_;
  focal_ = focal_pixels_ * steps;
  middle_x_ = viewport.width / 2 * steps;
  middle_y_ = viewport.height / 2 * steps;
}

pointskin::Camera Camera::matrices(const RenderOptions& options) const {
  pointskin::Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  const std::array<Vec3d, 3> axes = {axes_.right, axes_.up, axes_.back};
  const Vec3d centre_world = origin_ + centre_;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) camera.view[4 * row + a] = axes[row][a];
    camera.view[4 * row + 3] = -dot(axes[row], centre_world) - (row == 2 ? distance_ * radius_ : 0);
  }
  const double scale = perspective_ ? 1 : 1 / radius_;
  // The middle of the viewport, in clip coordinates; the scale of colours moves it to the left.
  const double steps = 1 << step_bits_;
  const double off_x = 2 * middle_x_ / steps / options.width - 1;
  camera.projection = {2 * focal_pixels_ * scale / options.width,
                       0,
                       0,
                       0,
                       0,
                       2 * focal_pixels_ * scale / options.height,
                       0,
                       0,
                       0,
                       0,
                       1,
                       0,
                       0,
                       0,
                       0,
                       0};
  camera.projection[perspective_ ? 2 : 3] = perspective_ ? 0 - off_x : off_x;
  camera.projection[perspective_ ? 14 : 15] = perspective_ ? -1 : 1;
  return camera;
}

Vec3d Camera::to_view(const Vec3d& direction) const {
  return {dot(axes_.right, direction), dot(axes_.up, direction), dot(axes_.back, direction)};
}

Vec3d Camera::to_world(const Vec3d& direction) const {
  return direction[0] * axes_.right + direction[1] * axes_.up + direction[2] * axes_.back;
}

Vec3d Camera::place(const Vec3d& point) const { return to_view(1 / radius_ * (point - centre_)); }

Vec3d Camera::point_at(const Vec3d& place) const { return centre_ + radius_ * to_world(place); }

ProjectedVertex Camera::project(const Vec3f& point) const {
  constexpr double kFarOff = 1 << 29;  // steps
  const Vec3d p = place(to_double(point));
  // Of what the camera is fitted to nothing is left out here; an orthographic nearness is 2 in the middle.
  const double depth = perspective_ ? distance_ - p[2] : p[2] + 2;
  if (!(depth > kLeastDistance / 2)) return {};
  const double weight = perspective_ ? 1 / depth : 1;
  const double x = middle_x_ + focal_ * p[0] * weight;
  const double y = middle_y_ - focal_ * p[1] * weight;
  if (!(std::abs(x) < kFarOff && std::abs(y) < kFarOff)) return {};
  ProjectedVertex result;
  result.x = static_cast<std::int32_t>(std::lround(x));
  result.y = static_cast<std::int32_t>(std::lround(y));
  result.nearness = static_cast<float>(perspective_ ? weight : depth);
  result.weight = static_cast<float>(weight);
  return result;
}

}  // namespace pointskin::render_detail
