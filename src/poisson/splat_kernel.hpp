// Distributing samples onto the corners of a brick, as a gather: no atomics, one fixed order.
// Source: Zhou et al. 2010, Listing 3, step 1 (a gather over 27 neighbours). Differs: whole bricks, and the quadratic
// B-spline besides the hat (docs/decisions/0002-splat-kernel.md).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/float8.hpp"
#include "octree/view.hpp"

namespace pointskin::poisson {

/// Linear B-spline, the basis itself.
struct HatKernel {
  static constexpr float kReach = 1;
  PSK_HD float operator()(float x) const {
    const float a = x < 0 ? -x : x;
    return a < 1 ? 1 - a : 0;
  }
};

/// Quadratic B-spline.
struct QuadraticKernel {
  static constexpr float kReach = 1.5F;
  PSK_HD float operator()(float x) const {
    const float a = x < 0 ? -x : x;
    if (a < 0.5F) return 0.75F - a * a;
    const float b = 1.5F - a;
    return a < 1.5F ? 0.5F * b * b : 0;
  }
#if PSK_WIDE
  PSK_INLINE Float8 operator()(const Float8& x) const {
    const Float8 a = select(x < 0, -x, x);
    const Float8 b = 1.5F - a;
    return select(a < 0.5F, 0.75F - a * a, select(a < 1.5F, 0.5F * b * b, Float8{}));
  }
#endif
};

/// A sample relative to a brick's first corner, in cells.
struct BrickSample {
  float rel[3];

  /// @param origin  coordinates of the brick's first node
  /// @param scale   2^depth
  PSK_HD BrickSample(const Vec3f& p, const octree::Coordinates& origin, float scale)
      : rel{p.x * scale - static_cast<float>(origin.x), p.y * scale - static_cast<float>(origin.y),
            p.z * scale - static_cast<float>(origin.z)} {}

  /// True if the kernel gives some corner of the brick a weight.
  template <class Kernel>
  [[nodiscard]] PSK_HD bool reaches() const {
    constexpr float kLower = -Kernel::kReach;
    constexpr float kUpper = 1 + Kernel::kReach;
    return rel[0] > kLower && rel[0] < kUpper && rel[1] > kLower && rel[1] < kUpper && rel[2] > kLower &&
           rel[2] < kUpper;
  }

  /// The same, without branches: of many samples around a brick about a third reaches it, in no order.
  template <class Kernel>
  [[nodiscard]] PSK_HD bool reaches_unordered() const {
    constexpr float kLower = -Kernel::kReach;
    constexpr float kUpper = 1 + Kernel::kReach;
    return (static_cast<int>(rel[0] > kLower) & static_cast<int>(rel[0] < kUpper) & static_cast<int>(rel[1] > kLower) &
            static_cast<int>(rel[1] < kUpper) & static_cast<int>(rel[2] > kLower) &
            static_cast<int>(rel[2] < kUpper)) != 0;
  }

  /// Weights on the brick's 8 corners.
  template <class Kernel>
  PSK_HD void weights(float (&w)[8]) const {
    const Kernel kernel;
    float axis[3][2];  // on lower and upper corners
    PSK_UNROLL
    for (int a = 0; a < 3; ++a) {
      axis[a][0] = kernel(rel[a]);
      axis[a][1] = kernel(rel[a] - 1);
    }
    PSK_UNROLL
    for (int s = 0; s < 8; ++s)
      w[s] = axis[0][octree::slot_x(s)] * axis[1][octree::slot_y(s)] * axis[2][octree::slot_z(s)];
  }

#if PSK_WIDE
  /// The same, a lane each.
  template <class Kernel>
  PSK_INLINE void weights(Float8& w) const {
    const Kernel kernel;
    w = kernel(rel[0] - Float8{0, 0, 0, 0, 1, 1, 1, 1}) * kernel(rel[1] - Float8{0, 0, 1, 1, 0, 0, 1, 1}) *
        kernel(rel[2] - Float8{0, 1, 0, 1, 0, 1, 0, 1});
  }
#endif
};

/// Coordinates of a brick's first node.
PSK_HD inline octree::Coordinates brick_origin(const octree::LevelView& level, std::int64_t brick) {
  const octree::Coordinates c = octree::decode(level.brick_key[brick]);
  return {2 * c.x, 2 * c.y, 2 * c.z};
}

/// Calls visit(first, last) for the points [first, last) of each cell brick around `brick` (itself included).
template <class Visit>
PSK_HD void for_points_around(const octree::LevelView& level, std::int64_t brick, const Visit& visit) {
  for (int j = 0; j < octree::kNeighbours; ++j) {
    const std::int32_t other = level.neighbours[brick * octree::kNeighbours + j];
    if (other < 0 || other >= level.cell_bricks) continue;
    const std::int32_t first = level.point_begin[8 * std::int64_t{other}];
    const std::int32_t last = level.point_begin[8 * std::int64_t{other} + 8];
    if (first < last) visit(first, last);
  }
}

}  // namespace pointskin::poisson
