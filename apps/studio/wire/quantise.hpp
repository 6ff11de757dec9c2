// Positions of 16 bits an axis, and normals of two bytes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

namespace pointskin::studio::wire {

/// Places in a box, 0 to 65535 along each axis.
class Grid {
 public:
  explicit Grid(const Bounds& box) : lower_(box.lower) {
    const Vec3f extent{box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z};
    scale_ = {per_step(extent.x), per_step(extent.y), per_step(extent.z)};
  }

  [[nodiscard]] std::array<std::uint16_t, 4> operator()(const Vec3f& p) const {
    return {step(p.x, lower_.x, scale_.x), step(p.y, lower_.y, scale_.y), step(p.z, lower_.z, scale_.z), 0};
  }

 private:
  static constexpr float kSteps = 65535;

  static float per_step(float extent) { return extent > 0 ? kSteps / extent : 0; }
  static std::uint16_t step(float x, float lower, float scale) {
    const float place = (x - lower) * scale + 0.5F;
    return static_cast<std::uint16_t>(place <= 0 ? 0 : place >= kSteps ? kSteps : place);
  }

  Vec3f lower_, scale_{};
};

/// A direction on the octahedron, folded to a square of 255 by 255 steps around (127, 127).
/// Source: Cigolle et al., "A survey of efficient representations for independent unit vectors", JCGT 3(2), 2014.
inline std::array<std::uint8_t, 2> octahedral(const Vec3f& n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0)) return {127, 127};
  float u = n.x / sum;
  float v = n.y / sum;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0F : 1.0F);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0F : 1.0F);
    u = folded;
  }
  const auto step = [](float x) { return static_cast<std::uint8_t>(127.5F + 127 * x); };  // never below 0
  return {step(u), step(v)};
}

}  // namespace pointskin::studio::wire
