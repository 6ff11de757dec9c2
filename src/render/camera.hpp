// Where points land on the picture.
#pragma once

#include <pointskin/camera.hpp>
#include <pointskin/render.hpp>

#include <cstdint>

#include "core/vec3.hpp"
#include "exec/cpu.hpp"
#include "render/fit_points.hpp"
#include "render/view_axes.hpp"

namespace pointskin::render_detail {

/// Fixed-point steps per pixel are a power of two: integer coordinates make neighbouring triangles meet without gaps.
/// Fewer where a large zoom would take corners of triangles beyond 32 bits, but at least 2^5.
inline constexpr int kMostStepBits = 9;

/// A point on the picture.
struct ProjectedVertex {
  std::int32_t x = kOutside, y = kOutside;  ///< steps from the left and from the top
  float nearness = 0;                       ///< larger is nearer; linear over a triangle on the picture
  float weight = 1;                         ///< attributes times weight are linear over a triangle on the picture

  static constexpr std::int32_t kOutside = INT32_MIN;
  [[nodiscard]] bool visible() const { return x != kOutside; }
};

/// The part of the picture, from its left and top, that the camera is fitted to; the rest is for the scale of colours.
struct Viewport {
  double width = 0, height = 0;  ///< pixels
};

/// The viewer's frame and its projection. Lengths are in radii of what is seen, about the middle of the picture.
class Camera {
 public:
  /// Fits the camera to `points`. O(points), a few times.
  /// @param origin  world position of the points' origin
  Camera(exec::Cpu& ex, const FitPoints& points, const Vec3d& origin, const RenderOptions& options);

  /// `point` is relative to the origin. One that is not finite, behind the viewer or far off the picture is invisible.
  [[nodiscard]] ProjectedVertex project(const Vec3f& point) const;

  /// A direction of the world in the viewer's frame: right, up, towards the viewer.
  [[nodiscard]] Vec3d to_view(const Vec3d& direction) const;
  /// And back.
  [[nodiscard]] Vec3d to_world(const Vec3d& direction) const;
  /// `point` in the viewer's frame: radii from the point in the middle of the picture.
  [[nodiscard]] Vec3d place(const Vec3d& point) const;
  /// And back.
  [[nodiscard]] Vec3d point_at(const Vec3d& place) const;

  /// The same view for interactive programs.
  [[nodiscard]] pointskin::Camera matrices(const RenderOptions& options) const;

  /// The up axis in the viewer's frame.
  [[nodiscard]] const Vec3d& up_in_view() const { return up_in_view_; }
  [[nodiscard]] int step_bits() const { return step_bits_; }
  [[nodiscard]] bool perspective() const { return perspective_; }
  [[nodiscard]] double radius() const { return radius_; }      ///< world units
  [[nodiscard]] double distance() const { return distance_; }  ///< radii, viewer to the middle
  [[nodiscard]] double focal() const { return focal_; }        ///< steps per radius at unit depth
  [[nodiscard]] double middle_x() const { return middle_x_; }  ///< steps
  [[nodiscard]] double middle_y() const { return middle_y_; }  ///< steps

 private:
  void orient(const RenderOptions& options);
  void fit_sphere(const Viewport& viewport, const RenderOptions& options);
  void fit_box(exec::Cpu& ex, const FitPoints& points, const Viewport& viewport, const RenderOptions& options);
  void choose_steps(const Viewport& viewport, const RenderOptions& options);

  ViewAxes axes_;
  Vec3d up_in_view_{0, 1, 0};
  Vec3d origin_{0, 0, 0};  // world
  Vec3d centre_{0, 0, 0};  // the point in the middle of the picture, relative to origin_
  double radius_ = 1;
  bool perspective_ = true;
  double distance_ = 1;
  double focal_pixels_ = 1;  // pixels per radius at unit depth
  double focal_ = 1;
  int step_bits_ = kMostStepBits;
  double middle_x_ = 0, middle_y_ = 0;
};

/// The part of a picture that a camera with these options is fitted to.
Viewport viewport_of(const RenderOptions& options);

}  // namespace pointskin::render_detail
