// Distributing samples onto the corners of a brick, as a gather: no atomics, one fixed order.
// Source: Zhou et al. 2010, Listing 3, step 1 (a gather over 27 neighbours). Differs: whole bricks, and the quadratic
// B-spline besides the hat (docs/decisions/0002-splat-kernel.md).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "octree/view.hpp"

namespace pointskin::poisson {

/// Linear B-spline, the basis itself; reach 1 cell.
struct HatKernel {
  PSK_HD float operator()(float x) const {
    const float a = x < 0 ? -x : x;
    return a < 1 ? 1 - a : 0;
  }
};

/// Quadratic B-spline; reach 1.5 cells.
struct QuadraticKernel {
  PSK_HD float operator()(float x) const {
    const float a = x < 0 ? -x : x;
    if (a < 0.5F) return 0.75F - a * a;
    const float b = 1.5F - a;
    return a < 1.5F ? 0.5F * b * b : 0;
  }
};

/// Weights of one sample on the two corners that a brick has along each axis.
struct BrickWeights {
  float axis[3][2];
  [[nodiscard]] PSK_HD float at(int slot) const {
    return axis[0][octree::slot_x(slot)] * axis[1][octree::slot_y(slot)] * axis[2][octree::slot_z(slot)];
  }
};

/// @param origin  coordinates of the brick's first node
/// @param scale   2^depth
template <class Kernel>
PSK_HD BrickWeights brick_weights(const Vec3f& p, const octree::Coordinates& origin, float scale) {
  const Kernel kernel;
  const float rel[3] = {p.x * scale - static_cast<float>(origin.x), p.y * scale - static_cast<float>(origin.y),
                        p.z * scale - static_cast<float>(origin.z)};
  BrickWeights weights{};
  for (int a = 0; a < 3; ++a) {
    weights.axis[a][0] = kernel(rel[a]);
    weights.axis[a][1] = kernel(rel[a] - 1);
  }
  return weights;
}

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
