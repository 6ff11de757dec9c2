#include "render/cloud_drawing.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <cmath>

#include "render/picture_scale.hpp"
#include "render/point_spacing.hpp"

namespace pointskin::render_detail {
namespace {

/// Diameter of a point, in spacings: of points at random, discs of radius r spacings leave exp(-pi r^2) uncovered, here
/// 1.6 %, and larger ones hide details of noisy scans.
constexpr double kSizeBySpacing = 2.3;
/// Radii in pixels, at scale 1 but for the least, which always covers a sample.
constexpr double kLeastRadius = 0.75, kLonePoint = 9, kLargestRadius = 40;
/// Balls are seen as balls from this radius on, in pixels; as grains of a surface below the other.
constexpr double kBall = 5, kGrain = 2;
/// A disc seen from its side keeps this share of its width: the cloud must not vanish. One that is turned away keeps
/// less: it would stand out behind what hides it.
constexpr double kLeastTilt = 0.3, kLeastTiltAway = 0.08;
/// By how much of its radius the middle of a disc is nearer than its rim, so that two that overlap part in the middle.
constexpr double kDiscBulge = 0.25;

/// Off the middle of a wide picture things are drawn out.
std::int32_t reach_of(double radius, const Vec3d& viewer) {
  return static_cast<std::int32_t>(std::ceil(radius / viewer[2])) + 1;
}

}  // namespace

double point_size_world(exec::Cpu& ex, const Cloud& cloud, const RenderOptions& options) {
  if (options.point_size > 0) return 0;
  if (options.point_size_world > 0) return options.point_size_world;
  const FitPoints points(cloud, std::nullopt, options.threads);
  const Vec3d centre = points.centre(ex);
  return kSizeBySpacing * point_spacing(ex, cloud.positions, centre, points.radius_about(ex, centre));
}

CloudDrawing::CloudDrawing(exec::Cpu& ex, const Cloud& cloud, const Camera& camera, const Paint& paint,
                           const RenderOptions& options, double size_world)
    : cloud_(cloud),
      camera_(camera),
      paint_(paint),
      options_(options),
      normals_(options.smooth && cloud.has_normals()),
      steps_(1 << camera.step_bits()),
      fixed_(options.point_size / 2 * steps_),
      radius_(size_world / 2 / camera.radius()),
      points_(ex.pool(), cloud.size()) {
  if (options.point_size == 0 && size_world == 0) fixed_ = kLonePoint * picture_scale(options) * steps_;
  exec::for_each(ex, "project", points_.size(), [this](std::int64_t i) {
    points_.data()[i] = camera_.project(cloud_.positions[static_cast<std::size_t>(i)]);
  });
}

double CloudDrawing::radius_steps(const ProjectedVertex& at) const {
  if (fixed_ > 0) return std::max(fixed_, kLeastRadius * steps_);
  const double largest = options_.point_size_world > 0 ? 1e9 : kLargestRadius * picture_scale(options_) * options_.zoom;
  return std::clamp(radius_ * camera_.focal() * static_cast<double>(at.weight), kLeastRadius * steps_,
                    std::max(largest, kLeastRadius) * steps_);
}

double CloudDrawing::weight_in_middle() const { return camera_.perspective() ? 1 / camera_.distance() : 1; }

double CloudDrawing::usual_radius_pixels() const {
  ProjectedVertex middle;
  middle.weight = static_cast<float>(weight_in_middle());
  return radius_steps(middle) / steps_;
}

double CloudDrawing::usual_size_world() const {
  return 2 * usual_radius_pixels() * steps_ / (camera_.focal() * weight_in_middle()) * camera_.radius();
}

/// In the viewer's frame, of unit length; zero if there is none.
Vec3d CloudDrawing::normal_of(std::int64_t id) const {
  if (!normals_) return {0, 0, 0};
  const Vec3d normal = normalized(camera_.to_view(to_double(cloud_.normals[static_cast<std::size_t>(id)])));
  return std::isfinite(normal[0] + normal[1] + normal[2]) ? normal : Vec3d{0, 0, 0};
}

/// Unit vector from a point towards the viewer.
Vec3d CloudDrawing::to_viewer(const ProjectedVertex& at) const {
  if (!camera_.perspective()) return {0, 0, 1};
  return normalized({(camera_.middle_x() - at.x) / camera_.focal(), (at.y - camera_.middle_y()) / camera_.focal(), 1});
}

/// The ellipse is that of the plane at the point, to first order.
ScreenDisc CloudDrawing::disc_of(std::int64_t id) const {
  const ProjectedVertex& at = points_.data()[id];
  const double radius = radius_steps(at);
  const Vec3d viewer = to_viewer(at);
  Vec3d normal = normal_of(id);
  const double facing = dot(normal, viewer);
  if (facing < 0) normal = -1 * normal;
  const bool flat = normals_ && facing != 0 && radius > kGrain * steps_;
  if (!flat) normal = viewer;
  const double least = facing > 0 ? kLeastTilt : kLeastTiltAway;
  if (std::abs(facing) < least && flat) {
    const Vec3d along = normalized(normal - std::abs(facing) * viewer);
    normal = least * viewer + std::sqrt(1 - least * least) * along;
  }
  // A step on the picture to the right moves the point of the plane by (1, 0, z), downwards by (0, -1, z'), in steps at
  // the depth of the disc; a perspective line of sight is not along z.
  const Vec3d sight = 1 / viewer[2] * viewer;
  const double across = dot(normal, sight);
  const Vec3d right = Vec3d{1, 0, 0} - normal[0] / across * sight;
  const Vec3d down = Vec3d{0, -1, 0} - (-normal[1] / across) * sight;
  const double per = 1 / (radius * radius);
  ScreenDisc disc;
  disc.x = at.x;
  disc.y = at.y;
  disc.reach = reach_of(radius, viewer);
  disc.nearness = at.nearness;
  disc.xx = static_cast<float>(dot(right, right) * per);
  disc.xy = static_cast<float>(dot(right, down) * per);
  disc.yy = static_cast<float>(dot(down, down) * per);
  // Of a length towards the viewer the nearness grows by weight^2 of it (perspective), or by itself.
  const double weight = static_cast<double>(at.weight);
  const double per_length = camera_.perspective() ? weight * weight : 1;
  const double length_per_step = 1 / (camera_.focal() * weight);
  disc.slope_x = static_cast<float>(right[2] * length_per_step * per_length);
  disc.slope_y = static_cast<float>(down[2] * length_per_step * per_length);
  disc.bulge = static_cast<float>((flat ? kDiscBulge : 1.0) * radius * length_per_step * per_length);
  return disc;
}

Span CloudDrawing::rows(std::int64_t id) const {
  const ProjectedVertex& at = points_.data()[id];
  if (!at.visible()) return {};
  if (normals_ && !options_.back_faces && dot(normal_of(id), to_viewer(at)) < 0) return {};
  const std::int32_t reach = reach_of(radius_steps(at), to_viewer(at));
  return {at.y - reach, at.y + reach};
}

void CloudDrawing::draw(std::int64_t id, Band& band) const { band.draw(disc_of(id), static_cast<std::int32_t>(id)); }

Seen CloudDrawing::seen(std::int32_t id, std::int64_t x, std::int64_t y) const {
  const ProjectedVertex& at = points_.data()[id];
  Seen seen;
  seen.normal = normal_of(id);
  const double facing = dot(seen.normal, to_viewer(at));
  seen.front = facing >= 0;
  if (!seen.front) seen.normal = -1 * seen.normal;
  seen.albedo = seen.front ? paint_.at(static_cast<std::size_t>(id)) : behind();
  if (facing != 0) return seen;
  // A ball, as far as it is large enough to look like one.
  const double radius = radius_steps(at);
  const double dx = static_cast<double>(x - at.x) / radius;
  const double dy = static_cast<double>(at.y - y) / radius;
  seen.normal = normalized({dx, dy, std::sqrt(std::max(0.0, 1 - dx * dx - dy * dy)) + 0.05});
  seen.relief = std::clamp((radius / steps_ - kGrain) / (kBall - kGrain), 0.0, 1.0);
  return seen;
}

}  // namespace pointskin::render_detail
