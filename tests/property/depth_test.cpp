// The depth that a cloud supports.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <cmath>
#include <cstdint>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// Normally distributed, by Irwin and Hall.
double normal(test::Random& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.unit();
  return sum;
}

/// Each point moved along its normal.
Cloud noisy(Cloud cloud, double sigma, std::uint64_t seed) {
  test::Random random(seed);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const auto by = static_cast<float>(sigma * normal(random));
    const Vec3f& n = cloud.normals[i];
    Vec3f& p = cloud.positions[i];
    p = {p.x + by * n.x, p.y + by * n.y, p.z + by * n.z};
  }
  return cloud;
}

TEST(SuggestDepth, KnowsTheSpacing) {
  for (const std::int64_t n : {2'000, 30'000, 300'000}) {
    const double spacing = std::sqrt(4 * 3.14159265358979 / static_cast<double>(n));
    const DepthSuggestion suggested = suggest_depth(test::sphere_cloud(n, 1));
    EXPECT_NEAR(suggested.spacing, spacing, 0.15 * spacing);
    EXPECT_EQ(suggested.depth, std::lround(std::log2(2.2 / (spacing * std::sqrt(0.75)))));
  }
}

TEST(SuggestDepth, KnowsTheNoiseWhetherNarrowerOrWiderThanTheSpacing) {
  const Cloud clean = test::torus_cloud(200'000, 2);  // 0.009 apart
  for (const double sigma : {0.003, 0.01, 0.03}) {
    const Cloud cloud = noisy(clean, sigma, 3);
    EXPECT_NEAR(suggest_depth(cloud).noise, sigma, 0.25 * sigma);
    Cloud bare = cloud;
    bare.normals.clear();
    EXPECT_NEAR(suggest_depth(bare).noise, sigma, 0.35 * sigma);
  }
  EXPECT_LT(suggest_depth(clean).noise, 0.0002);
}

TEST(SuggestDepth, IsCoarserForMoreNoise) {
  const Cloud clean = test::torus_cloud(200'000, 4);
  int last = 20;
  for (const double sigma : {0.0, 0.005, 0.02, 0.06}) {
    const int depth = suggest_depth(noisy(clean, sigma, 5)).depth;
    EXPECT_LE(depth, last);
    last = depth;
  }
  EXPECT_EQ(suggest_depth(clean).depth, 9);  // 0.0083 apart in a cube of side 2.97
  EXPECT_LE(last, 5);
}

TEST(SuggestDepth, TakesNoWallForNoise) {
  const DepthSuggestion plate = suggest_depth(test::thin_plate_cloud(60'000, 6, 0.03));
  EXPECT_LT(plate.noise, 0.001);
  EXPECT_EQ(plate.depth, 8);  // 0.0115 apart in a cube of side 2.2
}

TEST(SuggestDepth, KeepsWithinTheMemory) {
  const Cloud cloud = test::sphere_cloud(300'000, 7);
  const DepthSuggestion free = suggest_depth(cloud);
  Options options;
  options.max_memory_bytes = estimate_device_bytes(cloud, {{.depth = free.depth - 2}});
  const DepthSuggestion kept = suggest_depth(cloud, options);
  EXPECT_EQ(kept.depth, free.depth - 2);
  EXPECT_EQ(kept.supported, free.supported);
}

TEST(SuggestDepth, IsWhatAnAutomaticDepthTakes) {
  const Cloud cloud = test::torus_cloud(20'000, 8);
  const test::Outcome chosen = test::run(cloud, {{.depth = Options::kAutomaticDepth}});
  EXPECT_EQ(chosen.report.depth, suggest_depth(cloud).depth);
  test::expect_same_bytes(chosen.mesh, test::run(cloud, {{.depth = chosen.report.depth}}).mesh);
}

TEST(SuggestDepth, DoesNotDependOnTheOrderOrOnStrays) {
  Cloud cloud = test::torus_cloud(20'000, 9);
  const DepthSuggestion suggested = suggest_depth(cloud);
  const DepthSuggestion other = suggest_depth(test::shuffled(cloud, 10), {}, Device::cpu(5));
  EXPECT_EQ(other.spacing, suggested.spacing);
  EXPECT_EQ(other.noise, suggested.noise);
  cloud.positions.push_back({1000, 0, 0});
  cloud.normals.push_back({1, 0, 0});
  EXPECT_EQ(suggest_depth(cloud).depth, suggested.depth);
}

TEST(SuggestDepth, RefusesWhatHasNone) {
  EXPECT_EQ(test::error_of([] { (void)suggest_depth(Cloud{}); }), ErrorCode::empty_result);
  Cloud one;
  one.positions.assign(100, {1, 2, 3});
  EXPECT_EQ(test::error_of([&] { (void)suggest_depth(one); }), ErrorCode::empty_result);
  one.positions[3].x = NAN;
  EXPECT_EQ(test::error_of([&] { (void)suggest_depth(one); }), ErrorCode::invalid_input);
}

}  // namespace
}  // namespace pointskin
