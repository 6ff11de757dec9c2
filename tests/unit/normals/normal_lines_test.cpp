// Neighbours against all pairs; planes, quadrics and curvatures against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "normals/estimate_normals.hpp"
#include "normals/neighbours.hpp"
#include "normals/prepared_cloud.hpp"
#include "normals/select_nth.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// A cloud, sorted, with its neighbours and lines.
struct Estimated {
  explicit Estimated(const Cloud& cloud, int threads = 2)
      : ex(threads),
        points(normals::prepare_cloud(ex, cloud)),
        neighbours(normals::find_neighbours(ex, search())),
        lines(normals::estimate_lines(ex, search(), neighbours.cview())) {}

  [[nodiscard]] octree::SearchView search() const { return {points.tree.view(), points.positions.cview(), {}}; }
  [[nodiscard]] std::int64_t size() const { return points.positions.size(); }
  [[nodiscard]] const Vec3f& truth(const Cloud& cloud, std::int64_t i) const {
    return cloud.normals[static_cast<std::size_t>(points.order.data()[i])];
  }
  /// |cosine| between the line at i and the cloud's normal there.
  [[nodiscard]] double agreement(const Cloud& cloud, std::int64_t i) const {
    const Vec3f n = lines.normals.data()[i], t = truth(cloud, i);
    return std::abs(double{n.x} * t.x + double{n.y} * t.y + double{n.z} * t.z);
  }

  exec::Cpu ex;
  normals::PreparedCloud points;
  exec::Buffer<std::int32_t> neighbours;
  normals::NormalLines lines;
};

/// The nearest other points of i, of all of them.
std::vector<std::int32_t> nearest_of_all(const Estimated& e, std::int64_t i) {
  const Vec3f* const p = e.points.positions.data();
  std::vector<std::pair<float, std::int32_t>> all;
  for (std::int32_t j = 0; j < e.size(); ++j) {
    const float x = p[i].x - p[j].x, y = p[i].y - p[j].y, z = p[i].z - p[j].z;
    if (j != i) all.emplace_back(x * x + y * y + z * z, j);
  }
  std::sort(all.begin(), all.end());
  std::vector<std::int32_t> ids(normals::kNeighbours, -1);
  for (std::size_t k = 0; k < std::min(ids.size(), all.size()); ++k) ids[k] = all[k].second;
  return ids;
}

void expect_nearest(const Cloud& cloud) {
  const Estimated e(cloud);
  for (std::int64_t i = 0; i < e.size(); i += 1 + e.size() / 300) {
    const std::int32_t* const found = e.neighbours.data() + i * normals::kNeighbours;
    ASSERT_EQ(std::vector<std::int32_t>(found, found + normals::kNeighbours), nearest_of_all(e, i)) << "point " << i;
  }
}

TEST(Neighbours, AreTheNearestOfAll) {
  expect_nearest(test::sphere_cloud(3000, 1));
  expect_nearest(test::box_cloud(2000, 2));
  expect_nearest(test::jittered(test::plane_cloud(2000, 3), 4, 0.3));
}

TEST(Neighbours, AreTheNearestOfAllWhereDensityJumps) {
  Cloud cloud = test::sphere_cloud(2000, 5, 0.01);  // a dense spot in a sparse shell
  test::append(cloud, test::sphere_cloud(1000, 6));
  expect_nearest(cloud);
}

TEST(Neighbours, AreTheNearestOfAllAmongEqualPoints) {
  Cloud cloud = test::sphere_cloud(50, 7);
  for (int copies = 0; copies < 5; ++copies) test::append(cloud, test::sphere_cloud(50, 7));
  expect_nearest(cloud);
}

TEST(Neighbours, AreTheNearestOfAllFarFromEverything) {
  Cloud cloud = test::sphere_cloud(20000, 10, 0.02);  // what the wide cells around a lone point hold
  test::append(cloud, test::sphere_cloud(12, 11));
  const Estimated e(cloud);
  for (std::int64_t i = 0; i < e.size(); ++i) {
    const Vec3f& p = cloud.positions[static_cast<std::size_t>(e.points.order.data()[i])];
    if (p.x * p.x + p.y * p.y + p.z * p.z < 0.25F) continue;
    const std::int32_t* const found = e.neighbours.data() + i * normals::kNeighbours;
    EXPECT_EQ(std::vector<std::int32_t>(found, found + normals::kNeighbours), nearest_of_all(e, i)) << "point " << i;
  }
}

TEST(Neighbours, OfFewPointsEndInNone) { expect_nearest(test::sphere_cloud(5, 8)); }

TEST(SelectNth, FindsWhatSortingPutsThere) {
  test::Random random(12);
  for (int count = 1; count <= 65; ++count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& v : values) v = std::floor(random.in(0, count / 2.0));  // some of them equal
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (int place = 0; place < count; ++place) {
      std::vector<double> mixed = values;
      EXPECT_EQ(normals::select_nth(mixed.data(), count, place), sorted[static_cast<std::size_t>(place)]);
      std::sort(mixed.begin(), mixed.end());
      EXPECT_EQ(mixed, sorted) << "a value was lost";
    }
  }
}

TEST(NormalLines, OfAPlaneAreExactAndFlat) {
  const Cloud cloud = test::plane_cloud(2000, 10);
  const Estimated e(cloud);
  for (std::int64_t i = 0; i < e.size(); ++i) {
    ASSERT_NEAR(e.lines.normals.data()[i].z, 1, 1e-6);
    ASSERT_GT(e.lines.flatness.data()[i], 0.99);
    ASSERT_NEAR(e.lines.curvature.data()[i], 0, 0.05);
  }
}

TEST(NormalLines, OfASphereHaveItsCurvature) {
  for (const double radius : {0.5, 2.0}) {
    const Cloud cloud = test::sphere_cloud(20'000, 11, radius);
    const Estimated e(cloud);
    double sum = 0;
    for (std::int64_t i = 0; i < e.size(); ++i) {
      ASSERT_GT(e.agreement(cloud, i), 0.999);
      const Vec3f n = e.lines.normals.data()[i], t = e.truth(cloud, i);
      const double sign = double{n.x} * t.x + double{n.y} * t.y + double{n.z} * t.z < 0 ? -1 : 1;
      sum += sign * e.lines.curvature.data()[i] / e.points.frame.size;
    }
    EXPECT_NEAR(sum / static_cast<double>(e.size()), 1 / radius, 0.02 / radius);
  }
}

TEST(NormalLines, StayOnTheirSideOfASharpEdge) {
  const Cloud cloud = test::box_cloud(40'000, 12);
  const Estimated e(cloud);
  std::int64_t wrong = 0;
  for (std::int64_t i = 0; i < e.size(); ++i) wrong += e.agreement(cloud, i) < 0.98 ? 1 : 0;
  EXPECT_LT(wrong, e.size() / 20);  // 12 edges with two rows of points are 3 %
}

TEST(NormalLines, OfNoisyPointsUseMoreOfThem) {
  const Cloud cloud = test::jittered(test::sphere_cloud(20'000, 13), 14, 0.03);  // more than the spacing
  const Estimated e(cloud);
  double sum = 0;
  for (std::int64_t i = 0; i < e.size(); ++i) sum += std::acos(std::min(1.0, e.agreement(cloud, i)));
  EXPECT_LT(sum / static_cast<double>(e.size()), 0.12);  // 7 degrees; 16 points alone give more than 20
  EXPECT_GT(e.lines.noise.data()[0] * e.points.frame.size, 0.005);
}

TEST(NormalLines, OfTwoNearSheetsAreThoseOfEither) {
  const Cloud cloud = test::thin_plate_cloud(40'000, 15, 0.02);  // 1.4 times the spacing apart
  const Estimated e(cloud);
  std::int64_t wrong = 0;
  for (std::int64_t i = 0; i < e.size(); ++i) wrong += e.agreement(cloud, i) < 0.9 ? 1 : 0;
  EXPECT_LT(wrong, e.size() / 25);
}

TEST(NormalLines, OfEqualPointsAreNoGuess) {
  Cloud cloud;
  for (int i = 0; i < 40; ++i) cloud.positions.push_back({1, 2, 3});
  cloud.positions.push_back({2, 2, 3});
  const Estimated e(cloud);
  for (std::int64_t i = 0; i < 40; ++i) EXPECT_EQ(e.lines.flatness.data()[i], 0);
}

/// Both smaller eigenvalues are rounding there: their ratio is anything.
TEST(NormalLines, OfPointsInALineAreFlatToAShare) {
  test::Random random(16);
  for (int line = 0; line < 200; ++line) {
    const auto coordinate = [&] { return static_cast<float>(random.unit() - 0.5); };
    const Vec3f along{coordinate(), coordinate(), coordinate()};
    Cloud cloud;
    for (int i = 0; i < 24; ++i) cloud.positions.push_back(along * static_cast<float>(random.below(7)));
    const Estimated e(cloud);
    for (std::int64_t i = 0; i < e.size(); ++i) {
      ASSERT_GE(e.lines.flatness.data()[i], 0) << "line " << line;
      ASSERT_LE(e.lines.flatness.data()[i], 1) << "line " << line;
    }
  }
}

}  // namespace
}  // namespace pointskin
