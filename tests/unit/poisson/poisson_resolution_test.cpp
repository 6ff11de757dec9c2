// Which cells count: splat depths between levels, their means, and the bricks that samples resolve.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "octree/keys.hpp"
#include "poisson/density.hpp"
#include "poisson/resolution.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

/// A plane with `dense` samples left of the middle and `sparse` ones right of it.
SmallTree two_densities(int dense, int sparse, int depth) {
  test::Random random(5);
  std::vector<Vec3f> positions;
  for (int i = 0; i < dense + sparse; ++i) {
    const double x = i < dense ? random.in(0.1, 0.5) : random.in(0.5, 0.9);
    positions.push_back({static_cast<float>(x), static_cast<float>(random.in(0.1, 0.9)), 0.503F});
  }
  return {positions, std::vector<Vec3f>(positions.size(), Vec3f{0, 0, 1}), depth};
}

void weigh(SmallTree& tree) { poisson::weigh_samples(tree.ex, tree.tree, {1.5, false}, tree.samples); }

std::uint64_t brick_of(const Vec3f& p, int level) {
  return octree::point_key(p.x, p.y, p.z) >> 3 * (octree::kPointBits - level + 1);
}

TEST(SplatDepth, PartsANormalBetweenTwoLevels) {
  EXPECT_EQ(poisson::finer_level(6.0F), 6);
  EXPECT_EQ(poisson::finer_level(6.25F), 7);
  for (const float depth : {5.0F, 5.25F, 5.5F, 6.0F, 6.75F}) {
    float sum = 0;
    for (int d = 0; d <= 8; ++d) sum += poisson::splat_share(depth, d);
    EXPECT_EQ(sum, 1) << depth;
    EXPECT_EQ(poisson::splat_share(depth, poisson::finer_level(depth)),
              1 - (static_cast<float>(poisson::finer_level(depth)) - depth));
  }
}

TEST(SplatDepth, SpeaksForAFourthOfTheFacesOfTheNextLevel) {
  for (int d = 2; d < 9; ++d) {
    EXPECT_EQ(poisson::sampled_share(6, d), d <= 6 ? 1.0F : std::ldexp(1.0F, -2 * (d - 6)));
    // Continuous in the splat depth, and never less on a coarser level.
    EXPECT_NEAR(poisson::sampled_share(6.0F + 1e-5F, d), poisson::sampled_share(6, d), 1e-4);
    EXPECT_GE(poisson::sampled_share(6.4F, d), poisson::sampled_share(6.4F, d + 1));
  }
}

TEST(Resolution, IsEverythingWhereSamplesAreDense) {
  SmallTree tree = two_densities(20'000, 20'000, 5);
  weigh(tree);
  const poisson::Resolution resolution = poisson::find_resolution(tree.ex, tree.tree, tree.samples);
  EXPECT_TRUE(resolution.bricks.empty());
  EXPECT_TRUE(resolution.unknowns.empty());
  for (std::int64_t i = 0; i < 40'000; ++i) ASSERT_EQ(tree.samples.splat_depths.data()[i], 5);
  EXPECT_EQ(tree.samples.splat_depth_set, 1U << 5);
  EXPECT_EQ(tree.samples.coarsest_splat_depth, 5);
}

TEST(Resolution, EvensOutSplatDepthsOverTheBricksAround) {
  constexpr int kDepth = 7;
  SmallTree tree = two_densities(12'000, 300, kDepth);
  weigh(tree);
  const std::vector<float> before(tree.samples.splat_depths.data(), tree.samples.splat_depths.data() + 12'300);
  std::map<std::uint64_t, std::pair<double, int>> sums;
  for (std::size_t i = 0; i < before.size(); ++i) {
    auto& [sum, count] = sums[brick_of(tree.samples.positions.data()[i], kDepth - 1)];
    sum += static_cast<double>(before[i]);
    ++count;
  }
  poisson::find_resolution(tree.ex, tree.tree, tree.samples);
  std::uint32_t levels = 0;
  int between = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const octree::Coordinates c = octree::decode(brick_of(tree.samples.positions.data()[i], kDepth - 1));
    double sum = 0;
    double count = 0;
    for (int j = 0; j < octree::kNeighbours; ++j) {
      const auto found = sums.find(octree::encode({c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1}));
      if (found == sums.end()) continue;
      sum += found->second.first;
      count += found->second.second;
    }
    double expected = std::min<double>(kDepth, sum / count);
    const double finer = std::ceil(expected);
    if (1 - 0.75 * (finer - expected) < static_cast<double>(poisson::kResolvedShare)) expected = finer - 1;
    const float depth = tree.samples.splat_depths.data()[i];
    ASSERT_NEAR(depth, expected, 1e-4) << i;
    levels |= 1U << static_cast<int>(depth) | 1U << poisson::finer_level(depth);
    between += depth != std::floor(depth) ? 1 : 0;
  }
  EXPECT_GT(between, 50);
  EXPECT_EQ(tree.samples.splat_depth_set, levels);
}

TEST(Resolution, MarksAGradedOctreeAroundTheSamplesThatResolveALevel) {
  constexpr int kDepth = 8;
  SmallTree tree = two_densities(30'000, 400, kDepth);
  weigh(tree);
  const poisson::Resolution resolution = poisson::find_resolution(tree.ex, tree.tree, tree.samples);
  ASSERT_FALSE(resolution.bricks.empty());
  const octree::OctreeView& view = tree.view;
  const auto counts = [&](int d, std::int32_t brick) {
    return resolution.bricks.data()[view.levels[d].first_node / 8 + brick] != 0;
  };
  for (int d = 0; d <= kDepth; ++d) {
    const octree::LevelView& level = view.levels[d];
    std::map<std::uint64_t, bool> resolving;  // bricks with a sample that resolves the level
    for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i)
      if (poisson::resolves(tree.samples.splat_depths.data()[i], d) && d > 0)
        resolving[brick_of(tree.samples.positions.data()[i], d)] = true;
    std::int64_t left_out = 0;
    for (std::int32_t b = 0; b < level.bricks; ++b) {
      const octree::Coordinates c = octree::decode(level.brick_key[b]);
      bool expected = d <= octree::kCompleteDepth;
      for (int j = 0; j < octree::kNeighbours; ++j) {
        const octree::Coordinates around{c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1};
        if (around.x < 0 || around.y < 0 || around.z < 0) continue;
        expected = expected || resolving.count(octree::encode(around)) != 0;
      }
      ASSERT_EQ(counts(d, b), expected) << "level " << d << " brick " << b;
      left_out += b < level.cell_bricks && !expected ? 1 : 0;
      if (!expected || d == 0 || b >= level.cell_bricks) continue;
      // The cell above, its brick and all bricks that touch the cell count too: leaves differ by one level at most.
      const octree::LevelView& above = view.levels[d - 1];
      for (int j = 0; j < octree::kNeighbours; ++j) {
        const std::int32_t cell = above.neighbour(level.parent[b], j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1);
        if (cell < 0 || !above.is_cell(cell)) continue;
        ASSERT_TRUE(counts(d - 1, cell >> 3)) << "level " << d << " brick " << b;
      }
    }
    if (d <= 5) {
      EXPECT_EQ(left_out, 0) << "level " << d;
    } else if (d == kDepth) {
      EXPECT_GT(left_out, 0);
    }

    const octree::LevelView& solved = resolution.view(tree.tree).levels[d];
    for (std::int32_t n = 0; n < level.nodes(); ++n) {
      bool expected = (level.unknowns[n >> 3] >> (n & 7) & 1) != 0;
      for (int s = 0; s < 8 && expected; ++s) {
        const std::int32_t cell = level.neighbour(n, -octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s));
        if (cell >= 0) expected = counts(d, cell >> 3);
      }
      ASSERT_EQ((solved.unknowns[n >> 3] >> (n & 7) & 1) != 0, expected) << "level " << d << " node " << n;
    }
  }
}

}  // namespace
}  // namespace pointskin
