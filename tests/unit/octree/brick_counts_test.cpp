// Bricks counted without a tree, against the tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "octree/brick_counts.hpp"
#include "octree/octree_data.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using octree::BrickCounts;

std::vector<std::uint64_t> sorted_keys(const std::vector<Vec3f>& unit) {
  std::vector<std::uint64_t> keys;
  for (const Vec3f& p : unit) keys.push_back(octree::point_key(p.x, p.y, p.z));
  std::sort(keys.begin(), keys.end());
  return keys;
}

/// Points near a sphere; some outside of the cube, whose keys lie on its faces.
std::vector<Vec3f> sphere_in_cube(std::int64_t n, std::uint64_t seed, float radius) {
  std::vector<Vec3f> unit;
  for (const Vec3f& p : sphere_cloud(n, seed).positions)
    unit.push_back({0.5F + radius * p.x, 0.5F + radius * p.y, 0.5F + radius * p.z});
  return unit;
}

std::int64_t cells_with_points(const octree::LevelView& level) {
  std::int64_t count = 0;
  for (std::int64_t i = 0; i < level.cells(); ++i) count += level.point_begin[i] < level.point_begin[i + 1] ? 1 : 0;
  return count;
}

void expect_counts_of_the_tree(const std::vector<Vec3f>& unit, int depth) {
  SCOPED_TRACE(std::to_string(unit.size()) + " points, depth " + std::to_string(depth));
  exec::Cpu ex(2);
  const std::vector<std::uint64_t> keys = sorted_keys(unit);
  const ArrayView<const std::uint64_t> view{keys.data(), static_cast<std::int64_t>(keys.size())};
  const std::vector<BrickCounts> counts = octree::count_bricks(ex, view, depth);
  const octree::OctreeData data = octree::build_octree(ex, view, depth);
  const octree::OctreeView tree = data.view();
  ASSERT_EQ(counts.size(), static_cast<std::size_t>(depth) + 1);
  for (int d = 0; d <= depth; ++d) {
    const BrickCounts& level = counts[static_cast<std::size_t>(d)];
    EXPECT_EQ(level.cell_bricks, tree.levels[d].cell_bricks) << "level " << d;
    EXPECT_EQ(level.bricks, tree.levels[d].bricks) << "level " << d;
    EXPECT_EQ(level.occupied_cells, cells_with_points(tree.levels[d])) << "level " << d;
  }
}

TEST(BrickCounts, AreThoseOfTheTree) {
  for (const int depth : {1, 3, 4, 5, 7, 9, 13, 20}) {
    expect_counts_of_the_tree(sphere_in_cube(2'000, 1, 0.4F), depth);
    expect_counts_of_the_tree(sphere_in_cube(2'000, 2, 0.6F), depth);  // beyond the cube's faces
    expect_counts_of_the_tree({{0.3F, 0.7F, 0.1F}}, depth);
    expect_counts_of_the_tree({{0, 0, 0}, {1, 1, 1}}, depth);  // corners of the cube
    expect_counts_of_the_tree({}, depth);
  }
  expect_counts_of_the_tree(sphere_in_cube(100'000, 3, 0.45F), 8);
}

}  // namespace
}  // namespace pointskin::test
