// The right-hand side and the collapsed samples, by their moments and by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "poisson/divergence.hpp"
#include "poisson/screening.hpp"
#include "poisson/splat_kernel.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

SmallTree random_samples(std::uint64_t seed, int depth, double lower, double upper) {
  test::Random random(seed);
  const std::vector<Vec3f> points = test::clustered_points(random, 12, 8, 0.04, lower, upper);
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d n = random.direction();
    normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
  }
  return {points, normals, depth};
}

/// Sums of b, of b times each coordinate (cells of the level), and of |b| over the corners of the cube.
struct Moments {
  double zeroth = 0, first[3] = {0, 0, 0}, magnitude = 0;
};
Moments moments(const octree::LevelView& level, const float* b) {
  Moments m;
  for (std::int64_t n = 0; n < level.nodes(); ++n) {
    const octree::Coordinates c = test::corner_at(level, n);
    if (!test::in_cube(level, c)) continue;
    const auto value = static_cast<double>(b[level.first_node + n]);
    m.zeroth += value;
    m.magnitude += std::abs(value);
    m.first[0] += value * c.x;
    m.first[1] += value * c.y;
    m.first[2] += value * c.z;
  }
  return m;
}

/// Weight of a sample at depth `d` on a corner.
double kernel_weight(const Vec3f& p, const octree::Coordinates& c, int d) {
  const poisson::QuadraticKernel kernel;
  const float scale = static_cast<float>(1 << d);
  return static_cast<double>(kernel(p.x * scale - static_cast<float>(c.x))) *
         static_cast<double>(kernel(p.y * scale - static_cast<float>(c.y))) *
         static_cast<double>(kernel(p.z * scale - static_cast<float>(c.z)));
}

TEST(Splat, FindsACornerForAllOfEverySamplesWeight) {
  for (const int depth : {2, 3, 5, 7}) {
    SmallTree tree = random_samples(1, depth, 0.4, 0.6);  // 1.5 cells away from the cube's faces
    const octree::LevelView& level = tree.view.finest();
    for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i) {
      double sum = 0;
      for (std::int64_t n = 0; n < level.nodes(); ++n)
        sum += kernel_weight(tree.samples.positions.data()[i], test::corner_at(level, n), depth);
      ASSERT_NEAR(sum, 1, 1e-5) << "depth " << depth << ", sample " << i;
    }
  }
}

TEST(Splat, VisitsEverySampleThatReachesABrick) {
  SmallTree tree = random_samples(2, 6, 0.02, 0.98);
  const octree::LevelView& level = tree.view.finest();
  for (std::int32_t brick = 0; brick < level.bricks; ++brick) {
    const auto brick_weight = [&](std::int64_t i) {
      double sum = 0;
      for (int s = 0; s < 8; ++s)
        sum += kernel_weight(tree.samples.positions.data()[i], test::corner_at(level, 8 * std::int64_t{brick} + s), 6);
      return sum;
    };
    double visited = 0;
    poisson::for_points_around(level, brick, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t i = first; i < last; ++i) visited += brick_weight(i);
    });
    double all = 0;
    for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i) all += brick_weight(i);
    ASSERT_NEAR(visited, all, 1e-6) << "brick " << brick;
  }
}

// Hats sum to 1, whose gradient is 0; and sum_i x_i phi_i = x, so the first moment is the integral of V itself: minus
// the sum of the samples' areas times normals, in cells^2 of the level. On complete levels, where V's support has all
// its cells.
TEST(Divergence, HasTheSamplesNormalsAsItsFirstMomentsOnCompleteLevels) {
  for (const int depth : {3, 4})
    for (const int coarsest : {depth, 3}) {
      SmallTree tree = random_samples(3, depth, 0.4, 0.6);
      test::Random random(5);
      tree.weigh_randomly(random, coarsest);
      const exec::Buffer<float> b = poisson::splat_divergence(tree.ex, tree.tree, tree.samples.view(), {});
      double total[3] = {0, 0, 0};
      for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i) {
        const Vec3f& n = tree.samples.normals.data()[i];
        const auto area = static_cast<double>(tree.samples.areas.data()[i]);
        total[0] -= area * n.x;
        total[1] -= area * n.y;
        total[2] -= area * n.z;
      }
      for (int d = 0; d <= depth; ++d) {
        const Moments m = moments(tree.view.levels[d], b.data());
        const double scale = std::ldexp(1.0, 2 * (d - depth));
        for (int a = 0; a < 3; ++a)
          EXPECT_NEAR(m.first[a], scale * total[a], 2e-6 * m.magnitude * (1 << d))
              << "level " << d << " of " << depth << ", coarsest " << coarsest << ", axis " << a;
      }
    }
}

TEST(Divergence, SumsToZeroOverEveryLevelForSamplesUpToTheCubesFaces) {
  for (const int depth : {1, 2, 4, 6, 7})
    for (const bool adaptive : {false, true}) {
      SmallTree tree = random_samples(4, depth, 0, 0.9999999);
      test::Random random(6);
      tree.weigh_randomly(random, adaptive ? std::min(depth, 2) : depth);
      const exec::Buffer<float> b = poisson::splat_divergence(tree.ex, tree.tree, tree.samples.view(), {});
      for (int d = 0; d <= depth; ++d) {
        const Moments m = moments(tree.view.levels[d], b.data());
        EXPECT_NEAR(m.zeroth, 0, 1e-5 * m.magnitude + 1e-6)
            << "level " << d << " of " << depth << (adaptive ? ", adaptive" : "");
      }
    }
}

TEST(Divergence, IsTheRestrictionOfTheFinerLevelsWhenAllSamplesAreSplattedAtTheFinest) {
  SmallTree tree = random_samples(5, 7, 0.1, 0.9);
  test::Random random(7);
  tree.weigh_randomly(random, 7);
  const exec::Buffer<float> b = poisson::splat_divergence(tree.ex, tree.tree, tree.samples.view(), {});
  for (int d = 0; d < 7; ++d) {  // sum_i b_i phi_i(x) at coarse corners against fine ones, by scattering
    const octree::LevelView& level = tree.view.levels[d];
    const octree::LevelView& below = tree.view.levels[d + 1];
    std::vector<double> expected(static_cast<std::size_t>(level.nodes()), 0.0);
    for (std::int64_t n = 0; n < below.nodes(); ++n) {
      const octree::Coordinates c = test::corner_at(below, n);
      if (!test::in_cube(below, c)) continue;
      const double value = b.data()[below.first_node + n];
      const int odd = octree::slot_of(c.x & 1, c.y & 1, c.z & 1);
      const int parents = 1 << ((odd & 1) + (odd >> 1 & 1) + (odd >> 2 & 1));
      for (int s = 0; s < 8; ++s) {
        if ((s & ~odd) != 0) continue;
        const std::int32_t corner = test::corner_of(level, below.parent[n >> 3], s);
        ASSERT_GE(corner, 0);
        expected[static_cast<std::size_t>(corner)] += 0.5 * value / parents;
      }
    }
    for (std::int64_t n = 0; n < level.nodes(); ++n)
      ASSERT_NEAR(b.data()[level.first_node + n], expected[static_cast<std::size_t>(n)], 1e-5) << "level " << d;
  }
}

/// Weight and weighted mean position in the cell of the samples of a cell; a sample that is sparse for level d weighs
/// less, by the square of its share.
poisson::CollapsedSample collapsed_by_hand(const SmallTree& tree, int d, std::int64_t cell) {
  const octree::LevelView& level = tree.view.levels[d];
  const octree::Coordinates c = test::corner_at(level, cell);
  double weight = 0;
  double mean[3] = {0, 0, 0};
  for (std::int32_t i = level.point_begin[cell]; i < level.point_begin[cell + 1]; ++i) {
    const auto depth = static_cast<double>(tree.samples.splat_depths.data()[i]);
    const double finer = std::ceil(depth);
    const double share = d < finer ? 1 : (0.25 + 0.75 * (depth - finer + 1)) * std::pow(4.0, finer - d);
    const double area = static_cast<double>(tree.samples.areas.data()[i]) * share * share;
    const Vec3f& p = tree.samples.positions.data()[i];
    weight += area;
    mean[0] += area * (std::ldexp(p.x, d) - c.x);
    mean[1] += area * (std::ldexp(p.y, d) - c.y);
    mean[2] += area * (std::ldexp(p.z, d) - c.z);
  }
  if (weight == 0) return {};
  return {static_cast<float>(mean[0] / weight), static_cast<float>(mean[1] / weight),
          static_cast<float>(mean[2] / weight), static_cast<float>(weight)};
}

TEST(Collapse, HoldsTheWeightedMeanOfTheSamplesOfEveryCellOfEveryLevel) {
  for (const int depth : {1, 4, 7})
    for (const int coarsest : {depth, std::max(1, depth - 3)}) {
      SmallTree tree = random_samples(6, depth, 0, 0.9999999);
      test::Random random(8);
      tree.weigh_randomly(random, coarsest);
      const poisson::Screening screening = poisson::collapse_samples(tree.ex, tree.tree, tree.samples.view());
      for (int d = 0; d <= depth; ++d) {
        const octree::LevelView& level = tree.view.levels[d];
        const poisson::ScreeningView view = screening.view(d);
        for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
          const std::int32_t place = view.brick_index[cell >> 3];
          const poisson::CollapsedSample s =
              place < 0 ? poisson::CollapsedSample{} : view.samples[8 * std::int64_t{place} + (cell & 7)];
          const poisson::CollapsedSample expected = collapsed_by_hand(tree, d, cell);
          ASSERT_NEAR(s.weight, expected.weight, 1e-5F * expected.weight) << "level " << d << " of " << depth;
          ASSERT_NEAR(s.x, expected.x, 1e-4) << "level " << d;
          ASSERT_NEAR(s.y, expected.y, 1e-4) << "level " << d;
          ASSERT_NEAR(s.z, expected.z, 1e-4) << "level " << d;
        }
      }
    }
}

}  // namespace
}  // namespace pointskin
