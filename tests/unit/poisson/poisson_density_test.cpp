// Sampling density, areas and splat depths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "poisson/density.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

/// Uniform samples of the square [lower, upper]^2 tilted out of z = `height` by `slope`, as a graph over x and y.
SmallTree plane_tree(std::int64_t n, double height, double slope, int depth, std::uint64_t seed = 1) {
  test::Random random(seed);
  std::vector<Vec3f> points;
  std::vector<Vec3f> normals;
  for (std::int64_t i = 0; i < n; ++i) {
    const double x = random.in(0.1, 0.9);
    const double y = random.in(0.1, 0.9);
    points.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(height + slope * (x - 0.5))});
    normals.push_back({0, 0, 2});
  }
  return {points, normals, depth};
}

double total_area(const SmallTree& tree) {  // in the unit cube
  double sum = 0;
  for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i) sum += static_cast<double>(tree.samples.areas.data()[i]);
  return std::ldexp(sum, -2 * tree.view.depth);
}

poisson::Density weigh(SmallTree& tree, const poisson::WeighOptions& options = {}) {
  return poisson::weigh_samples(tree.ex, tree.tree, options, tree.samples);
}

TEST(Density, CountsEverySampleOnceOnEveryLevel) {  // hats sum to one, and restriction conserves
  for (const int depth : {1, 2, 3, 5, 8}) {
    test::Random random(static_cast<std::uint64_t>(depth));
    SmallTree tree(test::clustered_points(random, 20, 25, 0.05, 0, 0.9999999), {}, depth);
    const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
    EXPECT_EQ(density.depth, std::max(0, depth - 2));
    for (int d = 0; d <= density.depth; ++d) {
      const octree::LevelView& level = tree.view.levels[d];
      double sum = 0;
      for (std::int64_t n = 0; n < level.nodes(); ++n)
        if (test::in_cube(level, test::corner_at(level, n))) sum += density.counts.data()[level.first_node + n];
      EXPECT_NEAR(sum, 500, 0.01) << "level " << d << " of " << depth;
    }
  }
}

TEST(Density, CountsAreTheSumsOfTheSamplesHats) {
  test::Random random(3);
  SmallTree tree(test::clustered_points(random, 3, 20, 0.05, 0.1, 0.9), {}, 7);
  const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
  for (int d = 0; d <= density.depth; ++d) {
    const octree::LevelView& level = tree.view.levels[d];
    const double scale = 1 << d;
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const octree::Coordinates c = test::corner_at(level, n);
      if (!test::in_cube(level, c)) continue;
      double expected = 0;
      for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i) {
        const Vec3f& p = tree.samples.positions.data()[i];
        expected += std::max(0.0, 1 - std::abs(p.x * scale - c.x)) * std::max(0.0, 1 - std::abs(p.y * scale - c.y)) *
                    std::max(0.0, 1 - std::abs(p.z * scale - c.z));
      }
      ASSERT_NEAR(density.counts.data()[level.first_node + n], expected, 1e-4) << "level " << d;
    }
  }
}

TEST(Density, AreasOfAPlanesSamplesSumToItsArea) {
  // The mean over heights and tilts is right (kPlaneFactor); a single height may be off by what the factor averages
  // over: between 1/2 (midway between corners) and 1 (on them) of a squared hat's sum against 2/3.
  for (const double slope : {0.0, 0.31, 0.77}) {
    double mean = 0;
    constexpr int kHeights = 8;
    for (int i = 0; i < kHeights; ++i) {
      SmallTree tree = plane_tree(20'000, 0.5 + (i + 0.5) / kHeights / 64, slope, 8, static_cast<std::uint64_t>(i) + 1);
      weigh(tree);
      mean += total_area(tree) / kHeights;
    }
    const double area = 0.64 * std::hypot(1, slope);
    EXPECT_NEAR(mean, area, 0.06 * area) << "slope " << slope;
  }
}

TEST(Density, AreasOfASpheresSamplesSumToItsArea) {
  for (const std::int64_t n : {2'000, 50'000}) {
    SmallTree tree = test::sphere_tree(n, 0.37, 8);
    weigh(tree);
    const double area = 4 * std::numbers::pi * 0.37 * 0.37;
    EXPECT_NEAR(total_area(tree), area, 0.06 * area) << n << " samples";
  }
}

TEST(Density, IsPositiveAtEverySampleHoweverFew) {
  for (const int n : {1, 2, 7})
    for (const int depth : {1, 2, 3, 6, 10}) {
      test::Random random(static_cast<std::uint64_t>(100 * n + depth));
      SmallTree tree(test::clustered_points(random, n, 1, 0, 0, 0.9999999), {}, depth);
      weigh(tree);
      for (std::int64_t i = 0; i < n; ++i) {
        ASSERT_GT(tree.samples.areas.data()[i], 0);
        ASSERT_TRUE(std::isfinite(tree.samples.areas.data()[i]));
      }
    }
}

TEST(Weigh, GivesNormalsUnitLengthAndLeavesZeroOnesZero) {
  test::Random random(4);
  const std::vector<Vec3f> points = test::clustered_points(random, 40, 1, 0);
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < points.size(); ++i)
    normals.push_back(i % 4 == 0 ? Vec3f{} : Vec3f{0.3F * static_cast<float>(i), -2, 1e-3F});
  SmallTree tree(points, normals, 6);
  weigh(tree);
  int zeros = 0;
  for (std::int64_t i = 0; i < tree.samples.normals.size(); ++i) {
    const Vec3f& n = tree.samples.normals.data()[i];
    if (n == Vec3f{})
      ++zeros;
    else
      ASSERT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-6);
  }
  EXPECT_EQ(zeros, 10);
}

TEST(Weigh, ScalesAreasByTheNormalsRelativeLengthWithConfidenceOnly) {
  SmallTree plain = plane_tree(500, 0.503, 0, 6);
  SmallTree confident = plane_tree(500, 0.503, 0, 6);
  // Every fifth normal is 6 times as long as the others: the mean is (6 + 4) / 5 = 2 of theirs, so areas scale by 3 and
  // 1/2.
  const auto is_long = [](std::int64_t i) { return i % 5 == 0; };
  for (std::int64_t i = 0; i < 500; ++i) {
    Vec3f& n = confident.samples.normals.data()[i];
    const float length = is_long(i) ? 6.0F : 1.0F;
    n = {0.5F * length * n.x, 0.5F * length * n.y, 0.5F * length * n.z};  // they come with length 2
  }
  weigh(plain, {1.5, false});
  weigh(confident, {1.5, true});
  for (std::int64_t i = 0; i < 500; ++i)
    ASSERT_FLOAT_EQ(confident.samples.areas.data()[i], (is_long(i) ? 3.0F : 0.5F) * plain.samples.areas.data()[i]);
}

TEST(Weigh, SplatsAtTheDepthWhoseKernelHoldsEnoughSamples) {
  constexpr int kDepth = 8;
  constexpr std::int64_t kSamples = 2379;
  SmallTree tree = plane_tree(kSamples, 0.503, 0, kDepth);
  const double per_face = static_cast<double>(kSamples) / 0.64 / std::ldexp(1, 2 * kDepth);
  for (const double wanted : {0.0, 1.5, 6.0, 96.0}) {
    weigh(tree, {wanted, false, false});
    // Estimates scatter by the square root of kReliableSamples and by the plane factor's 3/4..3/2.
    const double samples = per_face * static_cast<double>(poisson::kKernelFaces);
    const double expected = std::clamp(kDepth + std::log2(samples / wanted) / 2, 2.0, kDepth + 3.0);
    double sum = 0;
    for (std::int64_t i = 0; i < kSamples; ++i) {
      const auto depth = static_cast<double>(tree.samples.splat_depths.data()[i]);
      ASSERT_NEAR(depth, expected, wanted == 0 ? 0 : 0.9) << "samples per node " << wanted;
      sum += depth;
    }
    EXPECT_NEAR(sum / kSamples, expected, 0.2) << "samples per node " << wanted;
  }
}

TEST(Density, EvaluatesAtPointsAsAtSamples) {
  SmallTree tree = test::sphere_tree(3000, 0.3, 7);
  const poisson::Density density = weigh(tree, {1.5, false, false});  // with signs, areas are those on the own side
  std::vector<float> at(3000);
  poisson::evaluate_density(tree.ex, tree.tree, density, tree.samples.positions.cview(), {at.data(), 3000});
  for (std::size_t i = 0; i < at.size(); ++i) ASSERT_FLOAT_EQ(at[i], 1 / tree.samples.areas.data()[i]);
}

}  // namespace
}  // namespace pointskin
