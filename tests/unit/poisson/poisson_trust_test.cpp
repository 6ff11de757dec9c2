// Trust of samples from their scatter, against sums over all pairs of a cell in double.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "poisson/trust.hpp"
#include "support/shapes.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

constexpr int kDepth = 6;

/// A patch of a sphere in the unit cube, moved along its normals by up to `noise`.
test::SmallTree patch(double noise, std::uint64_t seed, int count = 20'000) {
  test::Random random(seed);
  std::vector<Vec3f> positions, normals;
  while (static_cast<int>(positions.size()) < count) {
    const double x = random.in(-1, 1);
    const double y = random.in(-1, 1);
    const double z = random.in(-1, 1);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 1 || length < 0.1) continue;
    const Vec3f n{static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
    const auto radius = static_cast<float>(0.4 + random.in(-noise, noise));
    positions.push_back({0.5F + radius * n.x, 0.5F + radius * n.y, 0.5F + radius * n.z});
    normals.push_back(n);
  }
  return {positions, normals, kDepth};
}

struct Vector {
  double x, y, z;
  explicit Vector(const Vec3f& v) : x(v.x), y(v.y), z(v.z) {}
  Vector(double x, double y, double z) : x(x), y(y), z(z) {}
  [[nodiscard]] Vector plus(const Vector& v, double share) const {
    return {x + share * v.x, y + share * v.y, z + share * v.z};
  }
  [[nodiscard]] double dot(const Vector& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// By definition: pairs of neighbours in order that lie in the same cell of `level`.
/// @param finer  by how much the sample's splat depth is above `depth`
double expected_trust(const test::SmallTree& tree, std::int64_t sample, int depth, int level, double finer) {
  const auto cell_of = [&](std::int64_t i) {
    const Vec3f& p = tree.samples.positions.data()[i];
    return octree::point_key(p.x, p.y, p.z) >> 3 * (octree::kPointBits - level);
  };
  double sum = 0;
  double pairs = 0;
  for (std::int64_t i = 0; i + 1 < tree.samples.positions.size(); ++i) {
    if (cell_of(i) != cell_of(sample) || cell_of(i + 1) != cell_of(sample)) continue;
    const Vector n(tree.samples.normals.data()[i]);
    const Vector m(tree.samples.normals.data()[i + 1]);
    const Vector step = Vector(tree.samples.positions.data()[i]).plus(Vector(tree.samples.positions.data()[i + 1]), -1);
    const double across = std::ldexp(n.plus(m, 1).dot(step) / 2, depth);
    const double along2 = std::ldexp(step.dot(step), 2 * depth) - across * across;
    if (n.dot(m) <= poisson::kPairAgreement || along2 >= poisson::kPairReach * poisson::kPairReach) continue;
    sum += across * across;
    pairs += 1;
  }
  const double prior = poisson::kTrustScale - poisson::kCleanVariance;
  const double variance = ((1 + 3 * finer) * sum / 2 + poisson::kPriorPairs * prior) / (pairs + poisson::kPriorPairs);
  return std::max<double>(poisson::kSmallestTrust, poisson::kTrustScale / (poisson::kCleanVariance + variance));
}

TEST(Trust, IsThatOfThePairsInTheCellTwoLevelsAboveTheSplatDepth) {
  for (const double noise : {0.0, 0.004, 0.02}) {
    test::SmallTree tree = patch(noise, 31);
    test::Random random(32);
    tree.weigh(1, kDepth);
    for (std::int64_t i = 0; i < tree.samples.splat_depths.size(); ++i)
      tree.samples.splat_depths.data()[i] = static_cast<float>(random.in(kDepth - 4, kDepth));
    tree.samples.coarsest_splat_depth = kDepth - 4;
    poisson::weigh_trust(tree.ex, tree.tree, tree.samples);
    for (std::int64_t i = 0; i < tree.samples.positions.size(); i += 97) {
      const auto splat_depth = static_cast<double>(tree.samples.splat_depths.data()[i]);
      const int depth = std::max<int>(static_cast<int>(splat_depth), kDepth - 2);
      const double expected = expected_trust(tree, i, depth, depth - 2, std::max(0.0, splat_depth - depth));
      ASSERT_NEAR(tree.samples.trust.data()[i], expected, 2e-3 * expected) << "noise " << noise << " sample " << i;
    }
  }
}

/// Mean over the samples.
double mean_trust(double noise) {
  test::SmallTree tree = patch(noise, 33);
  tree.weigh(1, kDepth);
  poisson::weigh_trust(tree.ex, tree.tree, tree.samples);
  double sum = 0;
  for (std::int64_t i = 0; i < tree.samples.trust.size(); ++i) sum += static_cast<double>(tree.samples.trust.data()[i]);
  return sum / static_cast<double>(tree.samples.trust.size());
}

TEST(Trust, FallsWithTheNoiseAndCurvatureAloneDoesNotLowerIt) {
  const double cell = 1.0 / (1 << kDepth);
  EXPECT_GT(mean_trust(0), 2.5);                                  // a sphere of 26 cells' radius
  EXPECT_NEAR(mean_trust(0.15 * std::sqrt(3.0) * cell), 1, 0.3);  // uniform noise of 0.15 cells' standard deviation
  EXPECT_LT(mean_trust(cell), 0.35);
  EXPECT_GE(mean_trust(8 * cell), poisson::kSmallestTrust);
}

TEST(Trust, GrowsOnCoarserLevelsUpToOne) {
  for (const float trust : {0.05F, 0.3F, 0.9F})
    for (const double splat_depth : {6.0, 6.25, 6.9, 7.0}) {
      const double variance = poisson::kTrustScale / static_cast<double>(trust) - poisson::kCleanVariance;
      float above = trust;
      for (int depth = 9; depth >= 0; --depth) {
        const float there = poisson::trust_at(trust, static_cast<float>(splat_depth), depth);
        ASSERT_GE(there, above);
        ASSERT_LE(there, 1);
        above = there;
        if (depth >= splat_depth) {
          ASSERT_EQ(there, trust);
        } else if (splat_depth == 6 || splat_depth == 7) {  // between whole depths the square of the scale is linear
          const double seen = variance * std::exp2(2 * (depth - splat_depth));
          ASSERT_NEAR(there, std::min(1.0, poisson::kTrustScale / (poisson::kCleanVariance + seen)), 1e-5);
        }
      }
    }
  EXPECT_EQ(poisson::trust_at(3, 7, 2), 3);
}

TEST(Trust, IsOneWithoutPairs) {
  const std::vector<Vec3f> positions{{0.1F, 0.1F, 0.1F}, {0.9F, 0.9F, 0.9F}};
  test::SmallTree tree(positions, {{1, 0, 0}, {0, 1, 0}}, kDepth);
  tree.weigh(1, kDepth);
  poisson::weigh_trust(tree.ex, tree.tree, tree.samples);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(tree.samples.trust.data()[i], 1, 1e-6);
}

}  // namespace
}  // namespace pointskin
