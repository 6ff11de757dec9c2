// Samples that no neighbour confirms get no area; those of sparse parts of a surface keep theirs, but for a few.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "poisson/density.hpp"
#include "poisson/outliers.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

constexpr int kDepth = 7;

struct Points {
  std::vector<Vec3f> positions, normals;

  void add(const Vec3f& p, const Vec3f& n) {
    positions.push_back(p);
    normals.push_back(n);
  }

  /// Of the sphere of radius 0.3 around the middle, those with lower <= height < upper, in units of the radius.
  void add_sphere(test::Random& random, int count, double lower, double upper) {
    for (int i = 0; i < count; ++i) {
      const double z = random.in(lower, upper);
      const double angle = random.in(0, 6.283185307);
      const double r = std::sqrt(1 - z * z);
      const Vec3f n{static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                    static_cast<float>(z)};
      add(Vec3f{0.5F, 0.5F, 0.5F} + 0.3F * n, n);
    }
  }

  void add_noise(test::Random& random, int count) {
    for (int i = 0; i < count; ++i) {
      const Vec3f p{static_cast<float>(random.in(0.05, 0.95)), static_cast<float>(random.in(0.05, 0.95)),
                    static_cast<float>(random.in(0.05, 0.95))};
      const Vec3f n{static_cast<float>(random.in(-1, 1)), static_cast<float>(random.in(-1, 1)),
                    static_cast<float>(random.in(-1, 1))};
      add(p, n);
    }
  }
};

struct Weighed : SmallTree {
  explicit Weighed(const Points& points, bool drop_outliers = true)
      : SmallTree(points.positions, points.normals, kDepth) {
    poisson::weigh_samples(ex, tree, {1.5, false, drop_outliers}, samples);
  }
};

double height_above_sphere(const Vec3f& p) { return std::abs(std::hypot(p.x - 0.5, p.y - 0.5, p.z - 0.5) - 0.3); }

double usual_area(const SmallTree& tree) {  // harmonic mean, of samples that all have an area
  double densities = 0;
  for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i)
    densities += 1 / static_cast<double>(tree.samples.areas.data()[i]);
  return static_cast<double>(tree.samples.areas.size()) / densities;
}

std::int64_t without_area(const SmallTree& tree) {
  std::int64_t count = 0;
  for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i) count += tree.samples.areas.data()[i] == 0;
  return count;
}

TEST(Outliers, ActLikeAFewSamplesAtMostAndTheSurfaceStays) {
  for (const int outliers : {5, 50, 500}) {
    test::Random random(static_cast<std::uint64_t>(outliers));
    Points points;
    points.add_sphere(random, 10'000, -1, 1);
    points.add_noise(random, outliers);
    const Weighed before(points, false);
    const Weighed tree(points);
    const double usual = usual_area(before);
    double largest = 0;
    int strong = 0;
    for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i) {
      const auto area = static_cast<double>(tree.samples.areas.data()[i]);
      if (height_above_sphere(tree.samples.positions.data()[i]) < 1e-4) {
        ASSERT_GT(area, 0);
        continue;
      }
      largest = std::max(largest, static_cast<double>(before.samples.areas.data()[i]));
      // Usual areas on the own side are a little larger.
      strong += area > 1.01 * static_cast<double>(poisson::kUnusualArea) * usual;
    }
    EXPECT_GT(largest, 20 * usual) << outliers << " outliers";
    EXPECT_LE(strong, outliers / 40) << outliers << " outliers";
  }
}

TEST(Outliers, AreNotConfirmedByTwoThatNothingConfirms) {
  test::Random random(8);
  Points points;
  points.add_sphere(random, 10'000, -1, 1);
  points.add({0.9F, 0.86F, 0.9F}, {0.7F, 0, 0.7F});  // agrees with the next, but not with the last
  points.add({0.9F, 0.9F, 0.9F}, {0, 0, 1});
  points.add({0.9F, 0.94F, 0.9F}, {-0.7F, 0, 0.7F});
  EXPECT_EQ(without_area(Weighed(points)), 3);
}

TEST(Outliers, AreSeldomTheSamplesOfASparsePart) {
  test::Random random(3);
  Points points;
  points.add_sphere(random, 20'000, -1, 0);
  points.add_sphere(random, 200, 0, 1);
  EXPECT_LE(without_area(Weighed(points)), 50);
}

TEST(Outliers, AreSeldomTheSamplesOfASparseThinWall) {  // two sheets a cell apart, dense at one end
  test::Random random(4);
  Points points;
  for (int i = 0; i < 10'000; ++i) {
    const bool dense = i < 9'600;
    const bool upper = random.below(2) == 0;
    points.add({static_cast<float>(dense ? random.in(0.1, 0.3) : random.in(0.3, 0.9)),
                static_cast<float>(random.in(0.2, 0.8)), upper ? 0.508F : 0.5F},
               {0, 0, upper ? 1.0F : -1.0F});
  }
  EXPECT_LE(without_area(Weighed(points)), 100);  // 1 %
}

TEST(Outliers, AreClustersThatFaceAllWays) {
  test::Random random(6);
  Points points;
  points.add_sphere(random, 20'000, -1, 1);
  Points cluster;
  cluster.add_noise(random, 300);
  const auto squeezed = [](float x) { return 0.88F + 0.03F * (x - 0.5F); };
  for (std::size_t i = 0; i < 300; ++i) {
    const Vec3f p = cluster.positions[i];
    const Vec3f n = cluster.normals[i];
    points.add({squeezed(p.x), squeezed(p.y), squeezed(p.z)}, n);
  }
  const Weighed weighed(points);
  std::int64_t in_cluster = 0;
  for (std::int64_t i = 0; i < weighed.samples.areas.size(); ++i) {
    const bool is_outlier = height_above_sphere(weighed.samples.positions.data()[i]) > 1e-4;
    ASSERT_TRUE(is_outlier || weighed.samples.areas.data()[i] > 0);
    if (is_outlier && weighed.samples.areas.data()[i] > 0) ++in_cluster;
  }
  EXPECT_LT(in_cluster, 200);
}

/// A sphere of 20,000 samples, and `count` more at up to `height` distances between samples above or below it.
struct NearSphere : Points {
  NearSphere(test::Random& random, int count, double height, bool with_its_normals) {
    add_sphere(random, 20'000, -1, 1);
    const double spacing = std::sqrt(4 * 3.14159265 * 0.3 * 0.3 / 20'000);
    Points others;
    others.add_sphere(random, count, -1, 1);
    Points directions;
    directions.add_noise(random, count);
    for (std::size_t i = 0; i < others.positions.size(); ++i) {
      const double sign = random.below(2) == 0 ? -1 : 1;
      const auto away = static_cast<float>(spacing * sign * random.in(1, height));
      add(others.positions[i] + away * others.normals[i], with_its_normals ? others.normals[i] : directions.normals[i]);
    }
  }
};

/// Samples without area among those on the sphere, and their share among the others.
std::pair<std::int64_t, double> dropped(const Weighed& weighed) {
  std::int64_t inliers = 0;
  std::int64_t outliers = 0;
  std::int64_t gone = 0;
  for (std::int64_t i = 0; i < weighed.samples.areas.size(); ++i) {
    const bool has_area = weighed.samples.areas.data()[i] > 0;
    if (height_above_sphere(weighed.samples.positions.data()[i]) < 1e-4) {
      inliers += has_area ? 0 : 1;
    } else {
      ++outliers;
      gone += has_area ? 0 : 1;
    }
  }
  return {inliers, static_cast<double>(gone) / static_cast<double>(outliers)};
}

TEST(Outliers, NearTheSurfaceFaceNoneOfItsSamples) {
  test::Random random(8);
  const auto [inliers, share] = dropped(Weighed(NearSphere(random, 500, 4, false)));
  EXPECT_EQ(inliers, 0);
  EXPECT_GT(share, 0.8);
}

TEST(Outliers, StandOffTheSurfaceThatTheirNeighboursForm) {
  test::Random random(9);
  const auto [inliers, share] = dropped(Weighed(NearSphere(random, 100, 3, true)));
  EXPECT_EQ(inliers, 0);
  EXPECT_GT(share, 0.6);  // the others have fewer than 3 neighbours near them in key order
}

TEST(Outliers, AreHardlyAnyOfNoisySamples) {
  test::Random random(10);
  Points points;
  points.add_sphere(random, 20'000, -1, 1);
  const double spacing = std::sqrt(4 * 3.14159265 * 0.3 * 0.3 / 20'000);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    double gaussian = -6;  // of twelve uniform numbers
    for (int k = 0; k < 12; ++k) gaussian += random.in(0, 1);
    points.positions[i] = points.positions[i] + static_cast<float>(spacing * gaussian) * points.normals[i];
  }
  EXPECT_LT(without_area(Weighed(points)), 200);  // 1 %
}

TEST(Outliers, AreNotSamplesOfACloudWhoseNormalsAreNoise) {
  test::Random random(7);
  Points points;
  points.add_sphere(random, 20'000, -1, 1);
  for (Vec3f& n : points.normals)
    n = {static_cast<float>(random.in(-1, 1)), static_cast<float>(random.in(-1, 1)),
         static_cast<float>(random.in(-1, 1))};
  EXPECT_LT(without_area(Weighed(points)), 200);
}

TEST(Outliers, AreNeverAllSamples) {
  test::Random random(5);
  for (const int count : {1, 2, 3, 40}) {
    Points points;
    points.add_noise(random, count);
    EXPECT_LT(without_area(Weighed(points)), count);
  }
}

}  // namespace
}  // namespace pointskin
