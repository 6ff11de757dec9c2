// Problems whose solution is known:  u with -laplace u = 3 pi^2 u, a product of sines or cosines of pi x, pi y, pi z.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "octree/access.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin::test {

/// A tree whose levels are all complete: a point in every cell of the finest, at most 5.
inline SmallTree complete_tree(int depth) {
  const int side = 1 << depth;
  const auto middle = [&](int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(side); };
  std::vector<Vec3f> centres;
  for (int i = 0; i < side * side * side; ++i)
    centres.push_back({middle(i / (side * side)), middle(i / side % side), middle(i % side)});
  return {centres, {}, depth};
}

/// integral f phi_i / h with f = 3 pi^2 u over the cells of a complete level, by three Gauss points an axis.
template <class U>
void assemble_right_side(const octree::LevelView& level, const U& u, float* b) {
  const double h = 1.0 / static_cast<double>(1 << level.depth);
  const double points[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  const double weights[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  std::vector<double> sum(static_cast<std::size_t>(level.nodes()), 0.0);
  for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
    const octree::Coordinates c = corner_at(level, cell);
    for (int q = 0; q < 27; ++q) {
      const double x = points[q / 9];
      const double y = points[q / 3 % 3];
      const double z = points[q % 3];
      const double f = 3 * std::numbers::pi * std::numbers::pi * u((c.x + x) * h, (c.y + y) * h, (c.z + z) * h) *
                       weights[q / 9] * weights[q / 3 % 3] * weights[q % 3] * h * h;
      for (int s = 0; s < 8; ++s)
        sum[static_cast<std::size_t>(corner_of(level, cell, s))] += f * (octree::slot_x(s) != 0 ? x : 1 - x) *
                                                                    (octree::slot_y(s) != 0 ? y : 1 - y) *
                                                                    (octree::slot_z(s) != 0 ? z : 1 - z);
    }
  }
  for (std::size_t n = 0; n < sum.size(); ++n) b[n] = static_cast<float>(sum[n]);
}

/// The same for all levels.
template <class U>
exec::Buffer<float> right_side(SmallTree& tree, const U& u) {
  auto b = exec::make_buffer<float>(tree.ex, tree.view.nodes);
  for (int d = 0; d <= tree.view.depth; ++d)
    assemble_right_side(tree.view.levels[d], u, b.data() + tree.view.levels[d].first_node);
  return b;
}

/// Errors at the corners of the cube.
template <class U>
std::vector<double> errors_of(const octree::LevelView& level, const float* values, const U& u) {
  const double h = 1.0 / static_cast<double>(1 << level.depth);
  std::vector<double> errors;
  for (std::int64_t n = 0; n < level.nodes(); ++n) {
    const octree::Coordinates c = corner_at(level, n);
    if (in_cube(level, c)) errors.push_back(static_cast<double>(values[n]) - u(c.x * h, c.y * h, c.z * h));
  }
  return errors;
}

/// @param worst  error of each level, each half as wide as the one before
inline void expect_second_order(const std::vector<double>& worst) {
  for (std::size_t i = 1; i < worst.size(); ++i)
    EXPECT_NEAR(std::log2(worst[i - 1] / worst[i]), 2, 0.15) << worst[i - 1] << " -> " << worst[i];
  EXPECT_LT(worst.back(), 0.005);
}

}  // namespace pointskin::test
