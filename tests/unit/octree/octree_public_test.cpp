// The public octree: owners, ranges and searches against brute force.
#include <gtest/gtest.h>
#include <pointskin/error.hpp>
#include <pointskin/octree.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "support/shapes.hpp"

namespace pointskin {
namespace {

constexpr std::uint64_t kSeed = 7;

std::vector<Vec3f> test_points() { return test::torus_cloud(3000, kSeed).positions; }

float distance(const Vec3f& a, const Vec3f& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

std::vector<Vec3f> test_queries() {
  std::vector<Vec3f> queries = test::sphere_cloud(60, kSeed + 1, 0.9).positions;
  queries.push_back({5, -4, 3});  // far outside of the cube
  queries.push_back(test_points().front());
  return queries;
}

TEST(Octree, EveryPointLiesInTheCellThatListsIt) {
  const std::vector<Vec3f> points = test_points();
  const Octree tree = Octree::build(points, {.depth = 6}, Device::cpu());
  const OctreeLevel level = tree.level(6);
  const std::vector<std::int32_t> order = tree.point_order();
  const double width = tree.cube_size() / 64;
  std::int64_t seen = 0;
  for (std::int32_t cell = 0; cell < level.cells; ++cell) {
    const auto c = level.coordinates(cell);
    for (std::int32_t i = level.point_begin[static_cast<std::size_t>(cell)];
         i < level.point_begin[static_cast<std::size_t>(cell) + 1]; ++i, ++seen) {
      const Vec3f p = points[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])];
      EXPECT_NEAR(p.x, tree.cube_lower()[0] + (c[0] + 0.5) * width, 0.5001 * width);
      EXPECT_NEAR(p.y, tree.cube_lower()[1] + (c[1] + 0.5) * width, 0.5001 * width);
      EXPECT_NEAR(p.z, tree.cube_lower()[2] + (c[2] + 0.5) * width, 0.5001 * width);
    }
  }
  EXPECT_EQ(seen, tree.points());
}

TEST(Octree, CellsThatShareACornerEdgeOrFaceNameTheSameOwner) {
  const Octree tree = Octree::build(test_points(), {.depth = 5}, Device::cpu());
  const OctreeLevel level = tree.level(5);
  std::map<std::array<std::int32_t, 3>, std::int32_t> corners;
  std::map<std::tuple<std::array<std::int32_t, 3>, int>, std::int32_t> edges;
  for (std::int32_t cell = 0; cell < level.cells; ++cell) {
    const auto at = level.coordinates(cell);
    for (int k = 0; k < 8; ++k) {
      const std::int32_t owner = level.corner_owner(cell, k);
      ASSERT_GE(owner, 0);
      const std::array<std::int32_t, 3> corner{at[0] + (k >> 2), at[1] + (k >> 1 & 1), at[2] + (k & 1)};
      EXPECT_EQ(level.coordinates(owner), corner);
      EXPECT_EQ(corners.try_emplace(corner, owner).first->second, owner);
    }
    for (int e = 0; e < 12; ++e) {
      const OctreeOwner owner = level.edge_owner(cell, e);
      ASSERT_GE(owner.node, 0);
      EXPECT_EQ(edges.try_emplace({level.coordinates(owner.node), owner.axis}, owner.node).first->second, owner.node);
    }
    for (int f = 0; f < 6; ++f) {
      auto expected = at;
      expected[static_cast<std::size_t>(f / 2)] += f % 2;
      ASSERT_GE(level.face_owner(cell, f).node, 0);
      EXPECT_EQ(level.coordinates(level.face_owner(cell, f).node), expected);
    }
  }
}

TEST(Octree, LocatesTheLeafThatHoldsThePoint) {
  const std::vector<Vec3f> points = test_points();
  const Octree tree = Octree::build(points, {.depth = 7}, Device::cpu());
  for (const OctreeLeaf& leaf : tree.locate(points))
    EXPECT_EQ(leaf.depth, 7);  // occupied cells are on the finest level
}

TEST(Octree, FindsTheSameNearestPointsAsBruteForce) {
  const std::vector<Vec3f> points = test_points();
  const Octree tree = Octree::build(points, {.depth = 8}, Device::cpu());
  const std::vector<Vec3f> queries = test_queries();
  constexpr int kNeighbours = 12;
  const OctreeNeighbours found = tree.nearest(queries, kNeighbours);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    std::vector<float> expected;
    for (const Vec3f& p : points) expected.push_back(distance(p, queries[q]));
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(found.begin[q + 1] - found.begin[q], kNeighbours);
    for (std::int64_t i = 0; i < kNeighbours; ++i) {
      const auto at = static_cast<std::size_t>(found.begin[q] + i);
      EXPECT_NEAR(found.distances[at], expected[static_cast<std::size_t>(i)], 1e-5F * (1 + expected.front()));
      EXPECT_NEAR(distance(points[static_cast<std::size_t>(found.points[at])], queries[q]), found.distances[at],
                  1e-5F * (1 + expected.front()));
    }
  }
}

TEST(Octree, ReturnsAllPointsWhenFewerThanKExist) {
  const Octree tree = Octree::build(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {.depth = 3}, Device::cpu());
  const OctreeNeighbours found = tree.nearest(std::vector<Vec3f>{{0.9F, 0.1F, 0}}, 10);
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_EQ(found.points[0], 1);
}

TEST(Octree, FindsTheSamePointsWithinARadiusAsBruteForce) {
  const std::vector<Vec3f> points = test_points();
  const Octree tree = Octree::build(points, {.depth = 8}, Device::cpu());
  const std::vector<Vec3f> queries = test_queries();
  constexpr float kRadius = 0.15F;
  const OctreeNeighbours found = tree.within(queries, kRadius);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    std::set<std::int32_t> ids(found.points.begin() + found.begin[q], found.points.begin() + found.begin[q + 1]);
    EXPECT_EQ(static_cast<std::int64_t>(ids.size()), found.begin[q + 1] - found.begin[q]) << "no point twice";
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float d = distance(points[i], queries[q]);
      if (std::abs(d - kRadius) < 1e-5F) continue;  // rounding decides
      EXPECT_EQ(ids.count(static_cast<std::int32_t>(i)) == 1, d < kRadius);
    }
  }
}

TEST(Octree, RefusesWhatMakesNoSense) {
  const auto code = [](auto&& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code([] { Octree::build({}, {}, Device::cpu()); }), ErrorCode::empty_result);
  EXPECT_EQ(code([] {
              Octree::build(std::vector<Vec3f>{{1, 1, 1}, {1, 1, 1}}, {}, Device::cpu());
            }),
            ErrorCode::empty_result);
  EXPECT_EQ(code([] { Octree::build(test_points(), {.depth = 21}, Device::cpu()); }), ErrorCode::usage);
  const Octree tree = Octree::build(test_points(), {.depth = 3}, Device::cpu());
  EXPECT_EQ(code([&] { static_cast<void>(tree.nearest({}, 0)); }), ErrorCode::usage);
  EXPECT_EQ(code([&] { static_cast<void>(tree.within({}, -1)); }), ErrorCode::usage);
  EXPECT_EQ(code([&] { static_cast<void>(tree.level(4)); }), ErrorCode::usage);
  EXPECT_TRUE(tree.nearest({}, 3).points.empty());
  EXPECT_TRUE(tree.within({}, 1).points.empty());
}

}  // namespace
}  // namespace pointskin
