// The acid test of the extraction: whatever the corner values, a continuous field must give a closed manifold.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "unit/surface/hand_made_field.hpp"

namespace pointskin {
namespace {

using test::Random;
using test::SmallTree;

/// How the unknown corners get their values.
enum class Values { continuous, whole_numbers, rough_near_one_value };

float random_value(Random& random, Values values) {
  switch (values) {
    case Values::continuous:
      return static_cast<float>(random.in(-1, 1));
    case Values::whole_numbers:
      return static_cast<float>(random.below(3) - 1);  // often equal to the isovalue
    case Values::rough_near_one_value:
      return 0.37F + static_cast<float>(random.below(3) - 1) * 0x1p-25F;  // ulps apart
  }
  return 0;
}

/// Sharp transitions: clusters as small as a cell, deep below the complete levels, anywhere up to the cube's faces.
SmallTree random_tree(Random& random) {
  const int depth = 5 + static_cast<int>(random.below(4));
  const auto points = test::clustered_points(random, 1 + static_cast<int>(random.below(3)),
                                             1 + static_cast<int>(random.below(3)), random.in(0, 0.1), 0, 0.9999999);
  return {points, {}, depth};
}

std::vector<float> random_field(const SmallTree& tree, Random& random, Values values) {
  return test::continuous_values(
      tree.view, [&](const octree::LevelView&, const octree::Coordinates&) { return random_value(random, values); });
}

std::string counts(const MeshReport& r) {
  return "triangles " + std::to_string(r.triangles) + ", boundary " + std::to_string(r.boundary_edges) +
         ", non-manifold edges " + std::to_string(r.non_manifold_edges) + ", misoriented " +
         std::to_string(r.misoriented_edges) + ", non-manifold vertices " + std::to_string(r.non_manifold_vertices) +
         ", degenerate " + std::to_string(r.degenerate_triangles) + ", unused " +
         std::to_string(r.vertices - r.used_vertices);
}

/// Seeds are the loop's counter: a failure names the one to run again.
void expect_manifolds(Values values, float isovalue, float curvature, std::uint64_t seeds) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed);
    SmallTree tree = random_tree(random);
    const Mesh mesh =
        test::extracted(tree, random_field(tree, random, values), isovalue, true, {.curvature = curvature});
    const MeshReport report = measure(mesh);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", depth " + std::to_string(tree.view.depth) + ": " + counts(report));
    ASSERT_TRUE(report.closed());
    ASSERT_TRUE(report.manifold());
    ASSERT_TRUE(report.oriented());
    ASSERT_GT(report.volume, 0);
    ASSERT_EQ(report.vertices, report.used_vertices);
  }
}

TEST(RandomField, GivesAClosedManifoldForAnyValues) { expect_manifolds(Values::continuous, 0, 1, 60); }

TEST(RandomField, GivesAClosedManifoldWhenMostOfItIsInside) { expect_manifolds(Values::continuous, -0.6F, 0, 30); }

TEST(RandomField, GivesAClosedManifoldWhenMostOfItIsOutside) { expect_manifolds(Values::continuous, 0.6F, 0.5F, 30); }

TEST(RandomField, GivesAClosedManifoldWhenCornersEqualTheIsovalue) {
  expect_manifolds(Values::whole_numbers, 0, 1, 30);
  expect_manifolds(Values::whole_numbers, 1, 1, 15);
}

TEST(RandomField, GivesAClosedManifoldWhenInterpolatedCornersEqualTheIsovalue) {
  expect_manifolds(Values::whole_numbers, 0.5F, 0, 30);
}

TEST(RandomField, GivesAClosedManifoldWhenValuesDifferInTheLastBitOnly) {
  expect_manifolds(Values::rough_near_one_value, 0.37F, 1, 30);
}

/// Edges that only one triangle uses, as pairs of vertices.
std::vector<std::array<std::int32_t, 2>> boundary_edges(const Mesh& mesh) {
  std::map<std::array<std::int32_t, 2>, int> uses;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = t[k];
      const std::int32_t b = t[(k + 1) % 3];
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  std::vector<std::array<std::int32_t, 2>> result;
  for (const auto& [edge, count] : uses)
    if (count == 1) result.push_back(edge);
  return result;
}

/// True if both points lie on one and the same face of the unit cube.
bool share_cube_face(const Vec3f& p, const Vec3f& q) {
  for (const float side : {0.0F, 1.0F})
    if ((p.x == side && q.x == side) || (p.y == side && q.y == side) || (p.z == side && q.z == side)) return true;
  return false;
}

TEST(RandomField, EndsOnlyOnTheFacesOfAnOpenCube) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    SmallTree tree = random_tree(random);
    const auto values = random_field(tree, random, seed % 2 == 0 ? Values::continuous : Values::whole_numbers);
    const Mesh mesh = test::extracted(tree, values, 0, false);
    const MeshReport report = measure(mesh);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + counts(report));
    ASSERT_TRUE(report.manifold());
    ASSERT_TRUE(report.oriented());
    ASSERT_GT(report.boundary_edges, 0);
    for (const auto& edge : boundary_edges(mesh))
      ASSERT_TRUE(share_cube_face(mesh.vertices[static_cast<std::size_t>(edge[0])],
                                  mesh.vertices[static_cast<std::size_t>(edge[1])]))
          << "edge " << edge[0] << ", " << edge[1];
  }
}

TEST(RandomField, KeepsEveryVertexInTheCubeAndEveryNormalOfUnitLengthOrZero) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    SmallTree tree = random_tree(random);
    const Mesh mesh = test::extracted(tree, random_field(tree, random, Values::continuous), 0, true);
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Vec3f& p = mesh.vertices[i];
      ASSERT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1) << "seed " << seed;
      const Vec3f& n = mesh.normals[i];
      const float length = n.x * n.x + n.y * n.y + n.z * n.z;
      ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-5F) << "seed " << seed << ", squared length " << length;
    }
  }
}

TEST(RandomField, HasNoTrianglesWhereNothingCrosses) {
  Random random(7);
  SmallTree tree = random_tree(random);
  const auto values = random_field(tree, random, Values::continuous);
  const Mesh mesh = test::extracted(tree, values, 2, true);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.vertices.empty());
}

TEST(RandomField, IsCappedAllAroundWhenEverythingIsInside) {
  Random random(8);
  SmallTree tree = random_tree(random);
  const MeshReport report = measure(test::extracted(tree, random_field(tree, random, Values::continuous), -2, true));
  EXPECT_TRUE(report.watertight()) << counts(report);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
  // The caps lie kCrossingMargin inside of the faces; the cube's 12 edges are bevelled by at most the coarsest leaves'
  // width.
  const double h = 1.0 / (1 << octree::kCompleteDepth);
  EXPECT_GT(report.volume, 1 - 12 * h * h / 2 - 6 * 1e-3 * h);
  EXPECT_LT(report.volume, 1);
}

}  // namespace
}  // namespace pointskin
