// How much a surface bends from one sample to the next, from normals with and without noise.
#include "poisson/bend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "poisson/own_side.hpp"
#include "poisson/sum_hats.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

constexpr double kPi = 3.14159265358979;

double gaussian(test::Random& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.in(0, 1);
  return sum;
}

/// Estimates at a place where a surface bends by `along` and `across` (angles over the distance between samples) from 12
/// neighbours in a disc of radius 2.5: the mean of many.
/// @param noise  of the normals, radians
double mean_among_neighbours(double along, double across, double noise) {
  test::Random random(5);
  constexpr int kTrials = 3000;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    poisson::BendAmongNeighbours bend;
    const double own[2] = {noise * gaussian(random), noise * gaussian(random)};
    for (int i = 0; i < 12; ++i) {
      const double r = 2.5 * std::sqrt(random.in(0, 1));
      const double angle = random.in(0, 2 * kPi);
      const double turned = std::hypot(along * r * std::cos(angle) + noise * gaussian(random) - own[0],
                                       across * r * std::sin(angle) + noise * gaussian(random) - own[1]);
      bend.add(static_cast<float>(std::cos(turned)), static_cast<float>(r * r));
    }
    sum += static_cast<double>(bend.value());
  }
  return sum / kTrials;
}

TEST(BendAmongNeighbours, IsTheSquaredAngleFromSampleToSample) {
  for (const double angle : {0.02, 0.1, 0.25}) {
    EXPECT_NEAR(mean_among_neighbours(angle, angle, 0), 1.4 * angle * angle, 0.1 * angle * angle);  // a sphere
    EXPECT_NEAR(mean_among_neighbours(angle, 0, 0), 0.7 * angle * angle, 0.1 * angle * angle);      // a cylinder
  }
}

TEST(BendAmongNeighbours, IsNotMovedByNoiseOfTheNormals) {
  const double clean = mean_among_neighbours(0.25, 0.25, 0);
  EXPECT_NEAR(mean_among_neighbours(0.25, 0.25, 0.1), clean, 0.1 * clean);
}

TEST(BendAmongNeighbours, IsNotKnownFromFewNorFromFarOnes) {
  poisson::BendAmongNeighbours bend;
  for (int i = 0; i < 3; ++i) bend.add(1 - 0.01F * static_cast<float>(i), static_cast<float>(i));
  EXPECT_EQ(bend.value(), 0);
  for (int i = 0; i < 9; ++i) bend.add(0, 17);
  EXPECT_EQ(bend.value(), 0);
}

/// The median over the cells of a sphere's samples.
/// @param noise  of the normals, radians
double median_across_levels(std::int64_t points, double noise) {
  constexpr int kDepth = 7;
  constexpr double kRadius = 0.3;
  Cloud cloud = test::sphere_cloud(points, 3, kRadius, {0.5, 0.5, 0.5});
  test::Random random(4);
  const auto off = [&] { return static_cast<float>(noise * gaussian(random)); };
  for (Vec3f& n : cloud.normals) n = to_float(normalized(to_double(n + Vec3f{off(), off(), off()})));
  test::SmallTree tree(cloud.positions, cloud.normals, kDepth);
  constexpr int kCounted = kDepth - 2;
  const exec::Buffer<poisson::Facing> sums = poisson::sum_hats(
      tree.ex, tree.view, kCounted, tree.samples.positions.cview(), poisson::FacingOf{tree.samples.normals.cview()});
  const poisson::FacingView view{tree.view, kCounted, sums.data()};
  std::vector<double> bends;
  for (std::int64_t i = 0; i < tree.samples.positions.size(); i += 7)
    bends.push_back(static_cast<double>(view.bend_at(tree.samples.positions.data()[i], kCounted)));
  std::nth_element(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2), bends.end());
  return bends[bends.size() / 2];
}

TEST(BendAcrossLevels, IsTheSquaredAngleFromSampleToSampleHoweverNoisyTheNormals) {
  for (const std::int64_t points : {1000, 10'000, 100'000}) {
    const double angle2 = 4 * kPi / static_cast<double>(points);  // area of a sample over the squared radius
    for (const double noise : {0.0, 0.1, 0.3}) {
      const double bend = median_across_levels(points, noise);
      EXPECT_GT(bend, 0.4 * angle2) << points << " points, noise " << noise;
      EXPECT_LT(bend, 2.5 * angle2) << points << " points, noise " << noise;
    }
  }
}

TEST(BendAcrossLevels, IsLargeWhereBothSidesOfAWallMeet) {
  poisson::BendAcrossLevels bend;
  EXPECT_FALSE(bend.is_known());
  bend.add({0, 0, 1}, 4, 1);  // too few samples to tell
  bend.add({0, 0, 8}, 8, 4);
  EXPECT_FALSE(bend.is_known());
  bend.add({0, 0, 1}, 32, 16);
  EXPECT_TRUE(bend.is_known());
  EXPECT_GT(bend.value(), 0.3F);
  EXPECT_LT(bend.value(), 0.5F);
}

}  // namespace
}  // namespace pointskin
