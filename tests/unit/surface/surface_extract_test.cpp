// Surfaces of fields whose level set is known.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "unit/surface/hand_made_field.hpp"

namespace pointskin {
namespace {

using test::Random;
using test::SmallTree;

/// Leaves of all sizes between 1/16 and 1/2^depth.
SmallTree adaptive_tree(std::uint64_t seed, int depth) {
  Random random(seed);
  return {test::clustered_points(random, 3, 3, 0.03, 0.1, 0.9), {}, depth};
}

/// a . p - c, decreasing along -a: the inside is where a . p > c.
double plane(const Vec3d& a, double c, const Vec3d& p) { return a[0] * p[0] + a[1] * p[1] + a[2] * p[2] - c; }

double triangle_normal_dot(const Mesh& mesh, const Triangle& t, const Vec3d& a) {
  const Vec3d p = to_double(mesh.vertices[static_cast<std::size_t>(t[0])]);
  const Vec3d q = to_double(mesh.vertices[static_cast<std::size_t>(t[1])]);
  const Vec3d r = to_double(mesh.vertices[static_cast<std::size_t>(t[2])]);
  Vec3d u;
  Vec3d v;
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
  }
  return a[0] * (u[1] * v[2] - u[2] * v[1]) + a[1] * (u[2] * v[0] - u[0] * v[2]) + a[2] * (u[0] * v[1] - u[1] * v[0]);
}

struct PlaneCase {
  Vec3d direction;
  double offset;
};
const std::vector<PlaneCase>& plane_cases() {
  static const std::vector<PlaneCase> cases = {
      {{0, 0, 1}, 0.47}, {{0, -1, 0}, -0.47}, {{1, 1, 1}, 1.37}, {{0.3, -0.8, 0.52}, 0.1}, {{-0.9, 0.1, 0.2}, -0.3}};
  return cases;
}

class PlaneExtract : public testing::TestWithParam<float> {};  // curvature

// A linear function is its own interpolant on all levels and has constant slopes, so both fits find the plane exactly;
// the values' rounding (2^-24 of about 1) over the slope per edge (at least 2^-7) leaves 2^-17 of an edge.
TEST_P(PlaneExtract, LiesInThePlaneOfALinearFunctionAcrossAllLevels) {
  SmallTree tree = adaptive_tree(3, 7);
  for (const PlaneCase& c : plane_cases()) {
    const auto values = test::continuous_values(
        tree.view, test::at_positions([&](const Vec3d& p) { return plane(c.direction, c.offset, p); }));
    const Mesh mesh = test::extracted(tree, values, 0, false, {.curvature = GetParam()});
    ASSERT_FALSE(mesh.triangles.empty());
    // Where the plane passes within kCrossingMargin of a corner, vertices are moved by up to that part of a coarse
    // edge.
    const double moved = surface::kCrossingMargin / 16;
    for (const Vec3f& v : mesh.vertices) ASSERT_NEAR(plane(c.direction, c.offset, to_double(v)), 0, moved + 1e-6);
  }
}

TEST_P(PlaneExtract, FacesDownTheGradientWithNormalsAlongIt) {
  SmallTree tree = adaptive_tree(3, 7);
  for (const PlaneCase& c : plane_cases()) {
    const auto values = test::continuous_values(
        tree.view, test::at_positions([&](const Vec3d& p) { return plane(c.direction, c.offset, p); }));
    const Mesh mesh = test::extracted(tree, values, 0, false, {.curvature = GetParam()});
    double twice_area = 0;
    for (const Triangle& t : mesh.triangles) twice_area -= triangle_normal_dot(mesh, t, c.direction);
    EXPECT_GT(twice_area, 0);
    const double length = std::hypot(c.direction[0], c.direction[1], c.direction[2]);
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      const Vec3f& n = mesh.normals[i];
      const double cosine = -(n.x * c.direction[0] + n.y * c.direction[1] + n.z * c.direction[2]) / length;
      const Vec3f& v = mesh.vertices[i];
      ASSERT_GT(cosine, 1 - 1e-4) << "at " << v.x << " " << v.y << " " << v.z;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Fits, PlaneExtract, testing::Values(0.0F, 0.5F, 1.0F), [](const auto& info) {
  return info.param == 0 ? "Linear" : info.param == 1 ? "RescaledQuadratic" : "Halfway";
});

/// Distance to a sphere about the centre of the cube, positive inside.
test::CornerValue sphere_distance(double radius) {
  return test::at_positions(
      [radius](const Vec3d& p) { return radius - std::hypot(p[0] - 0.5, p[1] - 0.5, p[2] - 0.5); });
}

double worst_radius_error(const Mesh& mesh, double radius) {
  double worst = 0;
  for (const Vec3f& v : mesh.vertices)
    worst = std::max(worst, std::abs(std::hypot(v.x - 0.5, v.y - 0.5, v.z - 0.5) - radius));
  return worst;
}

// Trilinear interpolation of the distance to a sphere of radius r errs by up to 3 h^2 / 8 max |second derivative| = 3
// h^2 / (8 r) along the axes; the slope is 1. h = 1/16 is the coarsest leaf.
TEST(SphereExtract, IsAClosedSphereOnAnAdaptiveTreeWithinTheInterpolationError) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5})
    for (const float curvature : {1.0F, 0.5F, 0.0F}) {
      SmallTree tree = adaptive_tree(seed, 8);
      const double radius = 0.31;
      const Mesh mesh = test::extracted(tree, test::continuous_values(tree.view, sphere_distance(radius)), 0, true,
                                        {.curvature = curvature});
      const MeshReport report = measure(mesh);
      EXPECT_TRUE(report.watertight()) << "seed " << seed;
      EXPECT_EQ(report.components, 1) << "seed " << seed;
      EXPECT_EQ(report.euler, 2) << "seed " << seed;
      const double error = 3.0 / (8 * 256 * radius);
      EXPECT_LT(worst_radius_error(mesh, radius), error) << "seed " << seed;
      EXPECT_NEAR(report.volume, 4 * std::numbers::pi / 3 * std::pow(radius, 3), 3 * error / radius * report.volume);
    }
}

TEST(SphereExtract, IsFarCloserToTheSphereOnUniformCellsWithTheQuadraticFit) {
  Random random(1);
  SmallTree tree(test::clustered_points(random, 1, 1, 0), {}, octree::kCompleteDepth);
  const double radius = 0.31;
  const auto values = test::continuous_values(tree.view, sphere_distance(radius));
  const double linear = worst_radius_error(test::extracted(tree, values, 0, true, {.curvature = 0}), radius);
  const double quadratic = worst_radius_error(test::extracted(tree, values, 0, true, {.curvature = 1}), radius);
  EXPECT_LT(linear, 1.0 / (8 * 256 * radius));  // h^2 / 8 max |second derivative|
  EXPECT_LT(quadratic, linear / 4);
}

TEST(SphereExtract, IsCutFlatWhereItLeavesAClosedCubeAndOpenWhereItLeavesAnOpenOne) {
  SmallTree tree = adaptive_tree(6, 7);
  const double radius = 0.6;  // reaches 0.1 beyond the six faces, not the edges at 0.707
  const auto values = test::continuous_values(tree.view, sphere_distance(radius));
  const MeshReport closed = measure(test::extracted(tree, values, 0, true));
  EXPECT_TRUE(closed.watertight());
  EXPECT_EQ(closed.euler, 2);
  const MeshReport open = measure(test::extracted(tree, values, 0, false));
  EXPECT_TRUE(open.manifold());
  EXPECT_TRUE(open.oriented());
  EXPECT_GT(open.boundary_edges, 0);
  EXPECT_EQ(open.components, 1);
  EXPECT_EQ(open.euler, 2 - 6);  // a sphere with six holes
}

TEST(SphereExtract, ShrinksWithARisingIsovalue) {
  SmallTree tree = adaptive_tree(9, 6);
  const auto values = test::continuous_values(tree.view, sphere_distance(0.3));
  const double small = measure(test::extracted(tree, values, 0.1F, true)).volume;
  const double large = measure(test::extracted(tree, values, -0.1F, true)).volume;
  EXPECT_NEAR(small, 4 * std::numbers::pi / 3 * std::pow(0.2, 3), 0.05 * small);
  EXPECT_NEAR(large, 4 * std::numbers::pi / 3 * std::pow(0.4, 3), 0.05 * large);
}

TEST(SphereExtract, LeavesOutNormalsWhenTheyAreNotWanted) {
  SmallTree tree = adaptive_tree(2, 6);
  const auto values = test::continuous_values(tree.view, sphere_distance(0.3));
  const Mesh with = test::extracted(tree, values, 0, true, {.normals = true});
  const Mesh without = test::extracted(tree, values, 0, true, {.normals = false});
  EXPECT_EQ(with.normals.size(), with.vertices.size());
  EXPECT_TRUE(without.normals.empty());
  EXPECT_EQ(with.triangles, without.triangles);
  EXPECT_EQ(with.vertices, without.vertices);
}

TEST(SphereExtract, SortsVerticesByTheMortonKeyOfTheirCells) {
  SmallTree tree = adaptive_tree(2, 7);
  const Mesh mesh = test::extracted(tree, test::continuous_values(tree.view, sphere_distance(0.3)), 0, true);
  // A vertex lies at most one coarsest leaf above the corner that it is sorted by; keys of those blocks must ascend.
  std::uint64_t last = 0;
  for (const Vec3f& v : mesh.vertices) {
    const std::uint64_t key = octree::cell_key(octree::point_key(v.x, v.y, v.z), octree::kCompleteDepth);
    EXPECT_GE(key, last);
    last = key;
  }
}

TEST(CrossingParameter, IsTheRootOfAQuadraticThroughItsEnds) {
  Random random(11);
  for (int i = 0; i < 10'000; ++i) {
    const double u0 = random.in(-1, 0);
    const double u1 = random.in(0.01, 1);
    const double s0 = random.in(0, 2 * (u1 - u0));  // monotone: the end slopes have the sign of the difference
    for (const double sign : {1.0, -1.0}) {
      const auto t = static_cast<double>(surface::quadratic_root(
          static_cast<float>(sign * u0), static_cast<float>(sign * s0), static_cast<float>(sign * (u1 - u0))));
      ASSERT_GE(t, 0);
      ASSERT_LE(t, 1);
      ASSERT_NEAR(u0 + s0 * t + (u1 - u0 - s0) * t * t, 0, 1e-5) << u0 << " " << u1 << " " << s0;
    }
  }
}

}  // namespace
}  // namespace pointskin
