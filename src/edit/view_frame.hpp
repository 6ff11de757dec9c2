// A camera as kernels see it: the eye's frame, and the plane coordinates in which straight lines of sight are points.
//
// Plane coordinates (x, y) of a point: in a perspective view its eye coordinates divided by its depth, in an
// orthographic one the eye coordinates themselves; depth is the distance in front of the eye along the view. A pixel is
// one place of the plane, whatever the depth.
#pragma once

#include <pointskin/camera.hpp>
#include <pointskin/vector.hpp>

#include <array>

#include "core/host_device.hpp"

namespace pointskin::edit {

/// A place of the view's plane.
struct PlanePoint {
  double x = 0, y = 0;
};

struct ViewFrame {
  double right[3] = {1, 0, 0}, up[3] = {0, 1, 0}, back[3] = {0, 0, 1};  ///< the eye's axes; it looks along -back
  double eye[3] = {0, 0, 0};                                            ///< relative to the cloud's origin, world units
  bool perspective = true;

  /// What plane coordinates are multiplied with to give eye coordinates.
  [[nodiscard]] PSK_HD double scale_at(double depth) const { return perspective ? depth : 1; }

  [[nodiscard]] PSK_HD double depth_of(const Vec3f& p) const {
    return -(back[0] * (p.x - eye[0]) + back[1] * (p.y - eye[1]) + back[2] * (p.z - eye[2]));
  }

  /// True if the point is in front of the eye, where `place` receives its place on the plane.
  [[nodiscard]] PSK_HD bool project(const Vec3f& p, PlanePoint& place) const {
    const double d[3] = {p.x - eye[0], p.y - eye[1], p.z - eye[2]};
    const double depth = -(back[0] * d[0] + back[1] * d[1] + back[2] * d[2]);
    if (perspective && !(depth > 0)) return false;
    const double inverse = 1 / scale_at(depth);
    place = {(right[0] * d[0] + right[1] * d[1] + right[2] * d[2]) * inverse,
             (up[0] * d[0] + up[1] * d[1] + up[2] * d[2]) * inverse};
    return true;
  }

  [[nodiscard]] PSK_HD Vec3f unproject(const PlanePoint& place, double depth) const {
    const double x = place.x * scale_at(depth);
    const double y = place.y * scale_at(depth);
    const auto along = [&](int a) { return static_cast<float>(eye[a] + right[a] * x + up[a] * y - back[a] * depth); };
    return {along(0), along(1), along(2)};
  }

  /// A direction of the eye's frame (right, up, back) in the cloud's.
  [[nodiscard]] PSK_HD Vec3f direction(double x, double y, double z) const {
    const auto along = [&](int a) { return static_cast<float>(right[a] * x + up[a] * y + back[a] * z); };
    return {along(0), along(1), along(2)};
  }
};

/// The frame of a camera that validate() accepts.
/// @param origin  of the cloud
ViewFrame frame_of(const Camera& camera, const Vec3d& origin);

/// Place of a pixel on the plane of its camera.
PlanePoint to_plane(const Camera& camera, const Pixel& pixel);

}  // namespace pointskin::edit
