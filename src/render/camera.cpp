#include "render/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "mesh/mesh_checks.hpp"

namespace pointskin::render_detail {
namespace {

using mesh_detail::cross;
using mesh_detail::dot;
using mesh_detail::minus;
using mesh_detail::times;
using mesh_detail::to_double;

/// Half the angle under which a perspective viewer sees the bounding sphere.
constexpr double kHalfAngle = 14 * std::numbers::pi / 180;

/// Largest distance of a finite corner of a triangle from `centre`.
double radius_about(exec::Cpu& ex, const Mesh& mesh, const Vec3d& centre) {
  const auto n = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<double> largest(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)), 0);
  ex.run_blocks(static_cast<std::int64_t>(largest.size()), [&](std::int64_t b) {
    double squared = 0;
    for (std::int64_t t = b * exec::kCpuBlock; t < std::min(n, (b + 1) * exec::kCpuBlock); ++t)
      for (const std::int32_t id : mesh.triangles[static_cast<std::size_t>(t)]) {
        const double d =
            mesh_detail::squared_length(minus(to_double(mesh.vertices[static_cast<std::size_t>(id)]), centre));
        if (std::isfinite(d)) squared = std::max(squared, d);
      }
    largest[static_cast<std::size_t>(b)] = squared;
  });
  return largest.empty() ? 0 : std::sqrt(*std::max_element(largest.begin(), largest.end()));
}

/// A direction given with y up and the front at +z, for a mesh with `up`.
Vec3d turned(const Vec3d& v, UpAxis up) { return up == UpAxis::y ? v : Vec3d{v[0], -v[2], v[1]}; }

}  // namespace

Camera::Camera(exec::Cpu& ex, const Mesh& mesh, const RenderOptions& options)
    : centre_(options.target_world ? minus(*options.target_world, mesh.origin)
                                   : mesh_detail::corner_bounds(ex, mesh).centre()),
      perspective_(options.projection == Projection::perspective) {
  orient(options);
  const double radius = radius_about(ex, mesh, centre_);
  if (radius > 0) radius_ = radius;
  const double steps_per_pixel = kSupersampling * kSteps;
  const double radius_steps = kRenderFill * std::min(options.width, options.height) / 2 * steps_per_pixel;
  // A sphere's outline is the cone that touches it: sin(half angle) = radius / distance.
  distance_ = 1 / std::sin(kHalfAngle);
  focal_ = perspective_ ? radius_steps / std::tan(kHalfAngle) : radius_steps;
  middle_x_ = options.width / 2.0 * steps_per_pixel;
  middle_y_ = options.height / 2.0 * steps_per_pixel;
}

void Camera::orient(const RenderOptions& options) {
  const double azimuth = options.azimuth_degrees * std::numbers::pi / 180;
  const double elevation = options.elevation_degrees * std::numbers::pi / 180;
  const Vec3d back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                   std::cos(azimuth) * std::cos(elevation)};
  const Vec3d right{std::cos(azimuth), 0, -std::sin(azimuth)};
  back_ = turned(back, options.up);
  right_ = turned(right, options.up);
  up_ = cross(back_, right_);
  up_in_view_ = to_view(turned({0, 1, 0}, options.up));
}

pointskin::Camera Camera::matrices(const Vec3d& origin, const RenderOptions& options) const {
  pointskin::Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  const std::array<Vec3d, 3> axes = {right_, up_, back_};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) camera.view[4 * row + a] = axes[row][a];
    const Vec3d centre_world{origin[0] + centre_[0], origin[1] + centre_[1], origin[2] + centre_[2]};
    camera.view[4 * row + 3] = -dot(axes[row], centre_world) - (row == 2 ? distance_ * radius_ : 0);
  }
  const double pixels = focal_ / (kSupersampling * kSteps);  // per radius at unit depth
  const double scale = perspective_ ? 1 : 1 / radius_;
  camera.projection = {2 * pixels * scale / options.width,
                       0,
                       0,
                       0,
                       0,
                       2 * pixels * scale / options.height,
                       0,
                       0,
                       0,
                       0,
                       1,
                       0,
                       0,
                       0,
                       perspective_ ? -1.0 : 0.0,
                       perspective_ ? 0.0 : 1.0};
  return camera;
}

Vec3d Camera::to_view(const Vec3d& direction) const {
  return {dot(right_, direction), dot(up_, direction), dot(back_, direction)};
}

ProjectedVertex Camera::project(const Vec3f& vertex) const {
  const Vec3d p = to_view(times(1 / radius_, minus(to_double(vertex), centre_)));
  // Only vertices without a triangle lie outside of the sphere; they must merely not overflow.
  if (!(mesh_detail::squared_length(p) < 1.01)) return {};
  const double weight = perspective_ ? 1 / (distance_ - p[2]) : 1;
  ProjectedVertex result;
  result.x = static_cast<std::int32_t>(std::lround(middle_x_ + focal_ * p[0] * weight));
  result.y = static_cast<std::int32_t>(std::lround(middle_y_ - focal_ * p[1] * weight));
  result.nearness = static_cast<float>(perspective_ ? weight : p[2] + 2);
  result.weight = static_cast<float>(weight);
  return result;
}

}  // namespace pointskin::render_detail
