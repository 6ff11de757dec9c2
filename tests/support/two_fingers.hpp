// Two fingers whose gap nobody has scanned: automatic reconstruction joins them, two strokes part them.
#pragma once

#include <pointskin/camera.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/edit.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

#include "support/shapes.hpp"

namespace pointskin::test {

inline constexpr double kFingerRadius = 0.3, kFingerHalfLength = 0.6, kFingerAxis = 0.36;  ///< the gap is 0.12 wide

/// n samples of two capsules along y, at x = -kFingerAxis and kFingerAxis; none where they face each other.
inline Cloud two_fingers_cloud(std::int64_t n, std::uint64_t seed) {
  constexpr double kHidden = 0.2;  // the scanner has not seen anything nearer to the plane between them
  Random random(seed);
  Cloud cloud;
  while (cloud.size() < n) {
    const Vec3d d = random.direction();
    const double side = random.unit() < 0.5 ? -1 : 1;
    const double length = 2 * kFingerHalfLength;  // of the tube; the caps make a sphere: 2 r + length of height in all
    const double along = random.in(0, length + 2 * kFingerRadius);
    Vec3d normal = d;
    double y = d[1] > 0 ? kFingerHalfLength : -kFingerHalfLength;
    if (along < length) {
      const double flat = std::hypot(d[0], d[2]);
      normal = {d[0] / flat, 0, d[2] / flat};
      y = along - kFingerHalfLength;
    }
    const double x = side * kFingerAxis + kFingerRadius * normal[0];
    if (std::abs(x) < kHidden) continue;
    cloud.positions.push_back({static_cast<float>(x), static_cast<float>(y + kFingerRadius * normal[1]),
                               static_cast<float>(kFingerRadius * normal[2])});
    cloud.normals.push_back(
        {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])});
  }
  return cloud;
}

/// Looks along -z; 100 pixels are one unit, and the origin is in the middle of 400 x 400.
inline Camera front_camera() {
  Camera camera;
  camera.width = camera.height = 400;
  camera.projection[0] = camera.projection[5] = 0.5;
  return camera;
}
inline Pixel pixel_at(double x, double y) { return {200 + 100 * x, 200 - 100 * y}; }

/// The faces of the fingers that nobody has scanned: up along the left finger, down along the right one, so that
/// outside is to the right. The first parts the fingers; the second, whose face lies outside of what the first has
/// left, then tells how thick the right one is.
inline std::vector<Operation> parting_strokes() {
  const double x = kFingerAxis - kFingerRadius;
  const double y = kFingerHalfLength + 0.15;
  Guide left;
  left.camera = front_camera();
  left.stroke = {pixel_at(-x, -y), pixel_at(-x, y)};
  left.normals = GuideNormals::stroke;
  Guide right = left;
  right.stroke = {pixel_at(x, y), pixel_at(x, -y)};
  right.inside_only = false;
  return {left, right};
}

}  // namespace pointskin::test
