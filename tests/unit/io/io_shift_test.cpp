// The offset that is chosen on reading, with and without strays: the points keep their places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

/// A sphere of diameter 1 about `centre`, and strays at multiples of the number of points.
std::vector<Vec3d> sphere_at(const Vec3d& centre, std::int64_t n, const std::vector<Vec3d>& strays) {
  Random random(1);
  std::vector<Vec3d> points;
  for (std::int64_t i = 0; i < n; ++i) {
    const Vec3d d = random.direction();
    points.push_back({centre[0] + d[0] / 2, centre[1] + d[1] / 2, centre[2] + d[2] / 2});
  }
  for (std::size_t i = 0; i < strays.size(); ++i)
    points.insert(points.begin() + static_cast<std::ptrdiff_t>((i + 1) * points.size() / (strays.size() + 1)),
                  strays[i]);
  return points;
}

std::string text_of(const std::vector<Vec3d>& points) {
  std::string text;
  for (const Vec3d& p : points) {
    char line[100];
    const int length = std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
    text.append(line, static_cast<std::size_t>(length));
  }
  return text;
}

Cloud read(const std::vector<Vec3d>& points, int threads = 0) {
  return cloud_of("cloud.xyz", text_of(points), {.shift = {}, .threads = threads});
}

/// Largest error of the points that are not farther than 1 from `centre`.
double worst_error(const Cloud& cloud, const std::vector<Vec3d>& points, const Vec3d& centre) {
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    const Vec3d got{cloud.origin[0] + p.x, cloud.origin[1] + p.y, cloud.origin[2] + p.z};
    const auto error = [&](std::size_t a) { return std::abs(got[a] - points[i][a]); };
    if (std::hypot(points[i][0] - centre[0], points[i][1] - centre[1], points[i][2] - centre[2]) < 1)
      worst = std::max({worst, error(0), error(1), error(2)});
  }
  return worst;
}

const std::vector<Vec3d> kCentres{{0, 0, 0}, {100, 200, 300}, {2.6e6, 1.2e6, 400}, {-5e5, 4.6e6, 1e3}};

TEST(AutomaticShift, KeepsAnObjectExactWhateverStraysThereAre) {
  std::vector<std::vector<Vec3d>> all_strays{{}};
  for (const double far : {30.0, 1e3, 1e6, 1e9, 1e12, 1e30}) all_strays.push_back({{far, 0, 0}});
  all_strays.push_back({{0, 0, 0}});  // what scanners write for "nothing"
  all_strays.push_back({{1e9, 0, 0}, {-1e12, 0, 1}, {3, 4000, -2e6}, {0, 0, 1e37}});
  for (const Vec3d& centre : kCentres)
    for (std::size_t s = 0; s < all_strays.size(); ++s) {
      const std::vector<Vec3d> points = sphere_at(centre, 3'000, all_strays[s]);
      const Cloud cloud = read(points);
      SCOPED_TRACE("centre " + std::to_string(centre[0]) + ", strays number " + std::to_string(s));
      ASSERT_EQ(cloud.positions.size(), points.size());
      // Coordinates up to 1000 times the diameter of 1: the spacing of floats there, and double's near 5e6.
      EXPECT_LE(worst_error(cloud, points, centre), 0x1p-15 + 1e-9);
    }
}

TEST(AutomaticShift, IsThatOfAllPointsWhereThatIsExactEnough) {
  const auto centre_of = [](const std::vector<Vec3d>& points) {
    Vec3d centre{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                                   [&](const Vec3d& p, const Vec3d& q) { return p[a] < q[a]; });
      centre[a] = std::round(((*low)[a] + (*high)[a]) / 2) + 0.0;
    }
    return centre;
  };
  const Vec3d utm{2.6e6, 1.2e6, 400};
  for (const std::vector<Vec3d>& strays : {std::vector<Vec3d>{}, {{2.6e6 + 50, 1.2e6, 400}}}) {
    const std::vector<Vec3d> points = sphere_at(utm, 30'000, strays);
    EXPECT_EQ(read(points).origin, centre_of(points));
  }
  EXPECT_EQ(read(sphere_at({5, 5, 5}, 30'000, {})).origin, Vec3d{});
}

TEST(AutomaticShift, DoesNotDependOnTheOrderOfThePointsOrOnThreads) {
  std::vector<Vec3d> points = sphere_at({2.6e6, 1.2e6, 400}, 20'000, {{0, 0, 0}, {1e9, 0, 0}, {0, 1e10, 0}});
  const Vec3d expected = read(points, 1).origin;
  EXPECT_NEAR(expected[0], 2.6e6, 1);
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::shuffle(points.begin(), points.end(), std::mt19937_64(seed));
    EXPECT_EQ(read(points, 3).origin, expected);
  }
  std::sort(points.begin(), points.end(),
            [](const Vec3d& a, const Vec3d& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  EXPECT_EQ(read(points).origin, expected);
}

TEST(AutomaticShift, OfFewPointsCountsAllOfThem) {
  // Fewer than 128 points have no strays: all that is certain is that nothing breaks.
  const std::vector<Vec3d> points{{2.6e6, 0, 0}, {2.6e6, 1, 0}, {1e9, 0, 0}};
  EXPECT_EQ(read(points).origin, Vec3d{});
  EXPECT_EQ(read({{2.6e6, 0, 0}}).origin, (Vec3d{2.6e6, 0, 0}));
}

TEST(AutomaticShift, OfPointsAtOnePlaceAndAStrayIsThatPlace) {
  std::vector<Vec3d> points(1'000, {2.6e6, 1.2e6, 400});
  points.push_back({0, 0, 0});
  EXPECT_EQ(read(points).origin, (Vec3d{2.6e6, 1.2e6, 400}));
}

/// x, y and z of all points as bytes.
std::string floats_of(const std::vector<Vec3d>& points) {
  std::string bytes;
  for (const Vec3d& p : points)
    for (std::size_t a = 0; a < 3; ++a) bytes += raw<float>(static_cast<float>(p[a]));
  return bytes;
}

std::string ply_of_floats(const std::vector<Vec3d>& points) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + floats_of(points);
}

TEST(AutomaticShift, OfBinaryFloatsLosesNothingAndLeavesNearOnesWhereTheyAre) {
  for (const double far : {2e3, 1e6, 1.6e7}) {
    const std::vector<Vec3d> points = sphere_at({far, 0, -far}, 3'000, {});
    const Cloud cloud = cloud_of("a.ply", ply_of_floats(points));
    EXPECT_NEAR(cloud.origin[0], far, 1);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_EQ(cloud.origin[a] + static_cast<double>(cloud.positions[i][a]), static_cast<float>(points[i][a]));
  }
  EXPECT_EQ(cloud_of("a.ply", ply_of_floats(sphere_at({900, 0, 0}, 3'000, {}))).origin, Vec3d{});
}

TEST(AutomaticShift, OfSmallThingsIsFinerThanWholeNumbers) {
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12}) {
    std::vector<Vec3d> points = sphere_at({0, 0, 0}, 1'000, {});
    for (Vec3d& p : points) p = {0.4 + size * p[0], size * p[1], 0.3 + size * p[2]};
    const Cloud cloud = read(points);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(cloud.origin[a] + static_cast<double>(cloud.positions[i][a]), points[i][a],
                    0x1p-15 * size + 0x1p-53);
  }
}

}  // namespace
}  // namespace pointskin::test
