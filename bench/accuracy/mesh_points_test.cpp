#include "mesh_points.hpp"

#include <pointskin/error.hpp>

#include <gtest/gtest.h>

#include <cmath>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

/// Two triangles in planes across each other, of areas 1 and 3.
Mesh two_triangles() {
  Mesh mesh;
  mesh.origin = {10, 0, 0};
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {5, 0, 0}, {5, 3, 0}, {5, 0, 2}};
  mesh.triangles = {Triangle{0, 1, 2}, Triangle{3, 4, 5}};
  return mesh;
}

TEST(PointsOfAMesh, LieOnItsTrianglesWithTheirNormals) {
  const Cloud cloud = points_of(two_triangles(), 1000, 1);
  ASSERT_EQ(cloud.size(), 1000);
  EXPECT_EQ(cloud.origin, (Vec3d{10, 0, 0}));
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec3f p = cloud.positions[i];
    if (p.x < 3) {
      EXPECT_EQ(p.z, 0);
      EXPECT_GE(p.x, 0);
      EXPECT_GE(p.y, 0);
      EXPECT_LE(p.x / 2 + p.y, 1 + 1e-6F);
      EXPECT_EQ(cloud.normals[i], (Vec3f{0, 0, 1}));
    } else {
      EXPECT_EQ(p.x, 5);
      EXPECT_LE(p.y / 3 + p.z / 2, 1 + 1e-6F);
      EXPECT_EQ(cloud.normals[i], (Vec3f{1, 0, 0}));
    }
  }
}

TEST(PointsOfAMesh, AreAsManyPerAreaEverywhere) {
  constexpr int kPoints = 40'000;
  const Cloud cloud = points_of(two_triangles(), kPoints, 2);
  int first = 0;
  int near_corner = 0;  // the quarter of the first triangle that is nearest to its right angle
  for (const Vec3f& p : cloud.positions) {
    if (p.x > 3) continue;
    ++first;
    if (p.x < 1 && p.y < 0.5F && p.x / 2 + p.y < 0.5F) ++near_corner;
  }
  const double sigma = std::sqrt(kPoints * 0.25 * 0.75);
  EXPECT_NEAR(first, 0.25 * kPoints, 5 * sigma);
  EXPECT_NEAR(near_corner, 0.25 * first, 5 * std::sqrt(first * 0.25 * 0.75));
}

TEST(PointsOfAMesh, AreOthersForAnotherSeed) {
  const Mesh mesh = two_triangles();
  EXPECT_EQ(points_of(mesh, 100, 1).positions, points_of(mesh, 100, 1).positions);
  EXPECT_NE(points_of(mesh, 100, 1).positions, points_of(mesh, 100, 2).positions);
}

TEST(PointsOfAMesh, NeedAnArea) {
  Mesh flat = two_triangles();
  flat.vertices.assign(6, Vec3f{1, 1, 1});
  EXPECT_THROW((void)points_of(flat, 10, 1), Error);
  EXPECT_THROW((void)points_of(Mesh(), 10, 1), Error);
  EXPECT_THROW((void)points_of(two_triangles(), 0, 1), Error);
}

}  // namespace
}  // namespace pointskin::bench
