// Faults are as large as was asked for, and each alone.
#include "spoil.hpp"

#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/vec3.hpp"
#include "shapes.hpp"

namespace pointskin::bench {
namespace {

class Spoil : public testing::Test {
 protected:
  Cloud cloud_ = sample_surface(*make_shape("sphere"), {.points = 20'000, .seed = 4});
  static constexpr double kDiagonal = 3.4641;  // of the sphere's box
};

double radius(const Vec3f& p) { return length(to_double(p)); }

TEST_F(Spoil, LeavesAsItIsWhatIsNotAskedFor) {
  const Cloud same = spoil(cloud_, {});
  EXPECT_EQ(same.positions, cloud_.positions);
  EXPECT_EQ(same.normals, cloud_.normals);
}

TEST_F(Spoil, KeepsSoManyInTheirOrder) {
  const Cloud some = spoil(cloud_, {.keep = 1'000});
  ASSERT_EQ(some.size(), 1'000);
  auto at = cloud_.positions.begin();
  for (const Vec3f& p : some.positions) {
    at = std::find(at, cloud_.positions.end(), p);
    ASSERT_NE(at, cloud_.positions.end());
  }
  EXPECT_NE(spoil(cloud_, {.keep = 1'000, .seed = 2}).positions, some.positions);
}

TEST_F(Spoil, MakesNoiseOfTheSize) {
  const Cloud noisy = spoil(cloud_, {.sigma = 0.003});
  double sum = 0;
  for (const Vec3f& p : noisy.positions) sum += (radius(p) - 1) * (radius(p) - 1);
  EXPECT_NEAR(std::sqrt(sum / 20'000), 0.003 * kDiagonal, 0.0003);
}

TEST_F(Spoil, TurnsNormalsAndRoundsCoordinates) {
  const Cloud spoilt = spoil(cloud_, {.flipped = 0.1, .quantum = 0.01});
  int turned = 0;
  for (std::size_t i = 0; i < spoilt.positions.size(); ++i) {
    turned += spoilt.normals[i] == -1.0F * cloud_.normals[i] ? 1 : 0;
    EXPECT_LT(length(to_double(spoilt.positions[i]) - to_double(cloud_.positions[i])), 0.01 * kDiagonal);
  }
  EXPECT_NEAR(turned, 2'000, 150);
  std::set<float> values;
  for (const Vec3f& p : spoilt.positions) values.insert(p.x);
  EXPECT_LT(values.size(), 60U);
}

TEST_F(Spoil, AddsOutliersBetweenThePoints) {
  for (const int clusters : {0, 3}) {
    const Cloud spoilt = spoil(cloud_, {.outliers = 0.05, .clusters = clusters});
    const std::set<std::pair<float, float>> known = [&] {
      std::set<std::pair<float, float>> all;
      for (const Vec3f& p : cloud_.positions) all.insert({p.x, p.y});
      return all;
    }();
    std::vector<std::size_t> strange;
    for (std::size_t i = 0; i < spoilt.positions.size(); ++i)
      if (!known.contains({spoilt.positions[i].x, spoilt.positions[i].y})) strange.push_back(i);
    EXPECT_EQ(strange.size(), spoilt.positions.size() - 20'000);
    EXPECT_NEAR(static_cast<double>(strange.size()), 0.05 * static_cast<double>(spoilt.positions.size()), 1);
    EXPECT_LT(strange[strange.size() / 2], 14'000U) << "not all at the end";
    double far = 0;
    for (const std::size_t i : strange) {
      double nearest = 100;
      for (const std::size_t j : strange)
        if (j != i)
          nearest = std::min(nearest, length(to_double(spoilt.positions[i]) - to_double(spoilt.positions[j])));
      far += nearest;
    }
    EXPECT_EQ(far / static_cast<double>(strange.size()) < 0.02, clusters > 0) << clusters;
  }
}

TEST_F(Spoil, CutsHolesAndThinsOut) {
  const Cloud holed = spoil(cloud_, {.holes = 0.3, .hole_count = 3});
  EXPECT_NEAR(static_cast<double>(holed.size()), 14'000, 10);
  const Cloud thinned = spoil(cloud_, {.density_ratio = 100});
  const auto count = [](const Cloud& cloud, std::size_t axis, float from, float to) {
    return std::count_if(cloud.positions.begin(), cloud.positions.end(),
                         [&](const Vec3f& p) { return p[axis] >= from && p[axis] < to; });
  };
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest = std::max(largest, static_cast<double>(count(thinned, axis, -1, -0.9F)) /
                                    std::max(1.0, static_cast<double>(count(thinned, axis, 0.9F, 1.1F))));
  EXPECT_GT(largest, 40);
}

TEST_F(Spoil, DrawsPointsToLinesOnTheSurface) {
  const Cloud lines = spoil(cloud_, {.lines = 0.02});
  ASSERT_GT(lines.size(), 2'000);
  std::size_t drawn_axes = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::set<float> values;
    for (const Vec3f& p : lines.positions) values.insert(p[axis]);
    drawn_axes += values.size() < 100 ? 1 : 0;
  }
  EXPECT_EQ(drawn_axes, 1U);
  for (const Vec3f& p : lines.positions) EXPECT_NEAR(radius(p), 1, 0.001);
}

TEST(SpoilNested, SeesTheOutsideAlone) {
  const Cloud cloud = sample_surface(*make_shape("nested"), {.points = 10'000, .seed = 4});
  for (const Vec3f& p : spoil(cloud, {.outside = true}).positions)
    EXPECT_GT(std::abs(radius(p) - 0.6), 0.1) << "the wall of the cavity looks inwards";
}

TEST_F(Spoil, RefusesWhatIsOutOfRange) {
  EXPECT_THROW(spoil(Cloud{}, {}), Error);
  EXPECT_THROW(spoil(cloud_, {.outliers = 1}), Error);
  EXPECT_THROW(spoil(cloud_, {.density_ratio = 0.5}), Error);
  EXPECT_THROW(spoil(cloud_, {.hole_count = 0}), Error);
  EXPECT_THROW(spoil(cloud_, {.sigma = std::nan("")}), Error);
  cloud_.normals.clear();
  EXPECT_THROW(spoil(cloud_, {}), Error);
}

}  // namespace
}  // namespace pointskin::bench
