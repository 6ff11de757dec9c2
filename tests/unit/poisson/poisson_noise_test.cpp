// Normals are averaged over as many samples as the noise of a cloud, its bends and the way it was scanned ask for.
#include "poisson/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "poisson/density.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

constexpr int kDepth = 8;
constexpr double kRadius = 0.3;

/// By how much the noise of the whole and the bends around samples change splat depths, in the mean.
double mean_shift(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals) {
  double sum = 0;
  const auto depths = [&](bool has_signs) {
    SmallTree tree(positions, normals, kDepth);
    poisson::weigh_samples(tree.ex, tree.tree, {1.5, false, has_signs}, tree.samples);
    return std::vector<float>(tree.samples.splat_depths.data(),
                              tree.samples.splat_depths.data() + tree.samples.splat_depths.size());
  };
  const std::vector<float> with = depths(true);
  const std::vector<float> without = depths(false);
  for (std::size_t i = 0; i < with.size(); ++i) sum += static_cast<double>(with[i] - without[i]);
  return sum / static_cast<double>(with.size());
}

/// Of `count` samples of a sphere, each moved along its normal by a Gaussian.
/// @param noise  its deviation, in mean distances between samples
double shift_of_sphere(std::int64_t count, double noise) {
  Cloud cloud = test::sphere_cloud(count, 5, kRadius, {0.5, 0.5, 0.5});
  const double spacing = std::sqrt(4 * 3.14159265 * kRadius * kRadius / static_cast<double>(count));
  test::Random random(6);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    double gaussian = -6;  // of twelve uniform numbers
    for (int k = 0; k < 12; ++k) gaussian += random.in(0, 1);
    cloud.positions[i] = cloud.positions[i] + static_cast<float>(noise * spacing * gaussian) * cloud.normals[i];
  }
  return mean_shift(cloud.positions, cloud.normals);
}

TEST(Noise, LeavesCleanSamplesOfBendsFinerDepths) {
  EXPECT_GT(shift_of_sphere(300, 0), 0.2);  // neighbours 12 degrees apart: half of the samples
  EXPECT_GT(shift_of_sphere(100, 0), 0.7);  // 20 degrees
  EXPECT_LE(shift_of_sphere(20, 0), 0.5 * std::log2(poisson::kUsual / poisson::kFinest));
}

TEST(Noise, LeavesCleanSamplesOfSlowBendsTheirs) { EXPECT_NEAR(shift_of_sphere(30'000, 0), 0, 0.02); }

TEST(Noise, OfSlowBendsIsAveragedOverMoreSamplesThanThatOfFastOnes) {
  EXPECT_LT(shift_of_sphere(30'000, 0.25), -0.5);
  EXPECT_NEAR(shift_of_sphere(300, 0.25), 0, 0.25);
}

TEST(Noise, AsWideAsTheSpacingMakesDepthsAsCoarseAsTheyGet) {
  EXPECT_LT(shift_of_sphere(30'000, 1), -0.9);
  // rough_log2 is up to 0.09 too small.
  EXPECT_GE(shift_of_sphere(30'000, 1), -0.5 * (std::log2(poisson::kMost / poisson::kUsual) + 0.09F));
}

TEST(Averaging, FollowsNoiseAndBend) {
  const poisson::Averaging clean{0, poisson::kFinest};
  EXPECT_EQ(clean.samples(0), poisson::kUsual);
  EXPECT_NEAR(clean.samples(2 * poisson::kSharp), poisson::kUsual / 2, 1e-6);
  EXPECT_EQ(clean.samples(10), poisson::kFinest);
  const poisson::Averaging noisy{0.04F, 0.7F};
  EXPECT_EQ(noisy.samples(0), poisson::kMost);
  EXPECT_NEAR(noisy.samples(0.02F), 1.4 * std::sqrt(2.0), 1e-5);
  float last = poisson::kMost;
  for (float bend = 1e-5F; bend < 10; bend *= 1.3F) {
    EXPECT_LE(noisy.samples(bend), last);
    EXPECT_GE(noisy.samples(bend), clean.samples(bend));
    last = noisy.samples(bend);
  }
}

TEST(Averaging, OverFourTimesTheSamplesIsALevelCoarser) {
  EXPECT_EQ(poisson::Averaging::levels_finer(poisson::kUsual), 0);
  EXPECT_NEAR(poisson::Averaging::levels_finer(poisson::kUsual / 4), 1, 1e-6);
  EXPECT_NEAR(poisson::Averaging::levels_finer(4 * poisson::kUsual), -1, 1e-6);
  for (float m = 0.2F; m < 8; m += 0.1F)
    EXPECT_NEAR(poisson::Averaging::levels_finer(m), 0.5 * std::log2(1.5 / static_cast<double>(m)), 0.05);
}

TEST(Averaging, OverFewSamplesTrustsTheirPositionsMoreAndOverManyLess) {
  EXPECT_EQ(poisson::Averaging::urge(8, 0), 0.25F);
  EXPECT_EQ(poisson::Averaging::urge(1, 0), 2);
  EXPECT_EQ(poisson::Averaging::urge(poisson::kFinest, 0), poisson::kMostUrge);
}

TEST(Averaging, LeavesPositionsTrustedWhereTheFinestLevelAveragesMore) {
  constexpr float kMany = 8;
  const float alone = poisson::Averaging::urge(kMany, -1);
  EXPECT_FLOAT_EQ(alone, poisson::kUrgent / kMany);
  float last = alone;
  for (float beyond = 0; beyond <= 1; beyond += 0.0625F) {
    const float urge = poisson::Averaging::urge(kMany, beyond);
    EXPECT_GE(urge, last);
    EXPECT_FLOAT_EQ(poisson::Averaging::urge(0.5F, beyond), poisson::Averaging::urge(0.5F, 0));  // few count alone
    last = urge;
  }
  EXPECT_FLOAT_EQ(last, 1);
}

TEST(Noise, DoesNotTellTheDistanceBetweenScanLines) {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  test::Random random(7);
  constexpr int kLines = 20;
  for (int line = 1; line < kLines; ++line)
    for (int i = 0; i < 2000; ++i) {
      const double z = -1 + 2.0 * line / kLines;
      const double angle = random.in(0, 6.283185307);
      const double r = std::sqrt(1 - z * z);
      normals.push_back(
          {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), static_cast<float>(z)});
      positions.push_back(Vec3f{0.5F, 0.5F, 0.5F} + static_cast<float>(kRadius) * normals.back());
    }
  EXPECT_LT(mean_shift(positions, normals), 0.1);
}

TEST(Noise, IsNotKnownWithoutAPairThatAgrees) {
  const std::vector<Vec3f> one{{0.5F, 0.5F, 0.5F}};
  EXPECT_EQ(mean_shift(one, {{0, 0, 1}}), 0);
  const Vec3f up{0, 0, 1};
  const Vec3f down{0, 0, -1};
  EXPECT_EQ(mean_shift({{0.5F, 0.5F, 0.5F}, {0.6F, 0.5F, 0.5F}}, {up, down}), 0);  // no two that agree
}

}  // namespace
}  // namespace pointskin
