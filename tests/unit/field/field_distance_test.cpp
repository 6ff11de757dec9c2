// Signed distance to tangent planes, against all samples sorted by their distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "field/distance.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

Vec3f at_corner(const octree::LevelView& level, std::int64_t n) {
  const octree::Coordinates c = test::corner_at(level, n);
  const float width = std::ldexp(1.0F, -level.depth);
  return {static_cast<float>(c.x) * width, static_cast<float>(c.y) * width, static_cast<float>(c.z) * width};
}

/// The formula of the header in double.
double expected_at(const SmallTree& tree, const std::vector<float>& weights, const Vec3f& x) {
  std::vector<std::pair<double, std::int64_t>> order;
  const Vec3f* p = tree.samples.positions.data();
  const Vec3f* n = tree.samples.normals.data();
  const auto squared = [&](std::int64_t i) {
    const double dx = double{x.x} - p[i].x, dy = double{x.y} - p[i].y, dz = double{x.z} - p[i].z;
    return dx * dx + dy * dy + dz * dz;
  };
  for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i)
    if (!(n[i] == Vec3f{})) order.emplace_back(squared(i), i);
  std::sort(order.begin(), order.end());
  const bool full = order.size() >= std::size_t{field::kNearestSamples};
  order.resize(std::min(order.size(), std::size_t{field::kNearestSamples}));
  double sum = 0, weight = 0;
  for (const auto& [d, i] : order) {
    const double share = full ? 1 - d / order.back().first : 1;
    const double a = share * share * (weights.empty() ? 1 : weights[static_cast<std::size_t>(i)]);
    sum += a * ((double{x.x} - p[i].x) * n[i].x + (double{x.y} - p[i].y) * n[i].y + (double{x.z} - p[i].z) * n[i].z);
    weight += a;
  }
  return -std::ldexp(sum / weight, tree.view.depth);
}

void expect_planes(SmallTree& tree, const std::vector<float>& weights) {
  const auto n = static_cast<std::int64_t>(weights.size());
  const exec::Buffer<float> values = field::distance_to_planes(
      tree.ex, tree.tree,
      {tree.samples.positions.cview(), tree.samples.normals.cview(), ArrayView<const float>(weights.data(), n)});
  ASSERT_EQ(values.size(), tree.view.nodes);
  const double cells = std::ldexp(1.0, tree.view.depth);
  for (int d = 0; d <= tree.view.depth; ++d) {
    const octree::LevelView& level = tree.view.levels[d];
    for (std::int64_t i = 0; i < level.nodes(); ++i) {
      if (!test::in_cube(level, test::corner_at(level, i))) continue;
      const float value = values.data()[level.first_node + i];
      if (test::is_unknown(level, i)) {
        // Far away all weights are near 0, and float has fewer digits of them.
        ASSERT_NEAR(value, expected_at(tree, weights, at_corner(level, i)), 1e-5 * cells) << "level " << d;
      } else {
        const octree::LevelView& above = tree.view.levels[d - 1];
        ASSERT_EQ(value, octree::prolonged(above, values.data() + above.first_node, level.parent[i >> 3],
                                           static_cast<int>(i & 7)));
      }
    }
  }
}

TEST(DistanceToPlanes, IsTheMeanOverTheNearestSamples) {
  SmallTree tree = test::sphere_tree(700, 0.4, 6);
  expect_planes(tree, {});
}

TEST(DistanceToPlanes, FollowsTheWeights) {
  SmallTree tree = test::sphere_tree(300, 0.3, 5);
  test::Random random(3);
  std::vector<float> weights;
  for (int i = 0; i < 300; ++i) weights.push_back(static_cast<float>(random.in(0.1, 2)));
  expect_planes(tree, weights);
}

TEST(DistanceToPlanes, FindsTheNearestAcrossClustersOfAllSizes) {
  test::Random random(4);
  const std::vector<Vec3f> points = test::clustered_points(random, 6, 60, 0.02);
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d d = random.direction();
    normals.push_back({static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])});
  }
  SmallTree tree(points, normals, 7);
  expect_planes(tree, {});
}

TEST(DistanceToPlanes, LeavesOutSamplesWithoutANormal) {
  const Cloud cloud = test::sphere_cloud(200, 5, 0.3, {0.5, 0.5, 0.5});
  std::vector<Vec3f> normals = cloud.normals;
  for (std::size_t i = 0; i < normals.size(); i += 2) normals[i] = {};
  SmallTree tree(cloud.positions, normals, 5);
  expect_planes(tree, {});
}

TEST(DistanceToPlanes, DoesWithFewerSamplesThanItTakes) {
  const Cloud cloud = test::sphere_cloud(3, 6, 0.3, {0.5, 0.5, 0.5});
  SmallTree tree(cloud.positions, cloud.normals, 4);
  expect_planes(tree, {});
}

TEST(DistanceToPlanes, IsOnTheSideOfAFieldWhereThatIsSure) {
  SmallTree tree = test::sphere_tree(700, 0.4, 6);
  const field::TangentPlanes planes{tree.samples.positions.cview(), tree.samples.normals.cview(), {}};
  const exec::Buffer<float> without = field::distance_to_planes(tree.ex, tree.tree, planes);
  auto sides = exec::make_buffer<float>(tree.ex, tree.view.nodes);
  constexpr float kIsovalue = 0.5F;
  constexpr float kOffsets[] = {-0.4F, -0.9F * field::kSureSide, 0.9F * field::kSureSide, 0.4F};
  const auto offset = [&](std::int64_t node) { return kOffsets[node % 4]; };
  for (std::int64_t i = 0; i < tree.view.nodes; ++i) sides.data()[i] = kIsovalue + offset(i);
  const exec::Buffer<float> with = field::distance_to_planes(tree.ex, tree.tree, planes, {sides.data(), kIsovalue});
  const octree::LevelView& finest = tree.view.levels[tree.view.depth];
  std::int64_t turned = 0;
  for (std::int64_t i = 0; i < finest.nodes(); ++i) {
    if (!test::in_cube(finest, test::corner_at(finest, i)) || !test::is_unknown(finest, i)) continue;
    const std::int64_t node = finest.first_node + i;
    const float value = with.data()[node];
    ASSERT_NEAR(std::abs(value), std::abs(without.data()[node]), 1e-5);
    if (std::abs(offset(node)) < field::kSureSide)
      ASSERT_EQ(value, without.data()[node]);
    else
      ASSERT_EQ(value >= 0, offset(node) > 0);
    turned += (value >= 0) != (without.data()[node] >= 0);
  }
  EXPECT_GT(turned, finest.nodes() / 20);
}

TEST(DropPlanesOfOutliers, TakesTheNormalsOfSamplesWithoutArea) {
  exec::Cpu ex(1);
  auto normals = exec::make_buffer<Vec3f>(ex, 3);
  auto areas = exec::make_buffer<float>(ex, 3);
  for (int i = 0; i < 3; ++i) normals.data()[i] = {0, 0, 1};
  areas.data()[0] = 1, areas.data()[1] = 0, areas.data()[2] = 1e-30F;
  field::drop_planes_of_outliers(ex, areas.cview(), normals.view());
  EXPECT_EQ(normals.data()[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(normals.data()[1], Vec3f{});
  EXPECT_EQ(normals.data()[2], (Vec3f{0, 0, 1}));
}

TEST(Normalise, MakesUnitLengthsAndKeepsZeros) {
  exec::Cpu ex(1);
  auto normals = exec::make_buffer<Vec3f>(ex, 3);
  normals.data()[0] = {3, 0, 4};
  normals.data()[1] = {};
  normals.data()[2] = {0, 1e-30F, 0};
  field::normalise(ex, normals.view());
  EXPECT_EQ(normals.data()[0], (Vec3f{0.6F, 0, 0.8F}));
  EXPECT_EQ(normals.data()[1], Vec3f{});
  EXPECT_EQ(normals.data()[2], (Vec3f{0, 1, 0}));
}

}  // namespace
}  // namespace pointskin
