#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/vertex_normals.hpp>

#include <cmath>

#include "support/shapes.hpp"

namespace pointskin {
namespace {

double dot(const Vec3f& a, const Vec3f& b) { return double{a.x} * b.x + double{a.y} * b.y + double{a.z} * b.z; }

TEST(VertexNormals, PointOutwardFromASphere) {
  Mesh mesh = test::icosphere_mesh(4, 2, {5, 6, 7});
  const std::vector<Vec3f> exact = mesh.normals;
  mesh.normals.clear();
  add_vertex_normals(mesh);
  ASSERT_EQ(mesh.normals.size(), exact.size());
  for (std::size_t v = 0; v < exact.size(); ++v) {
    EXPECT_NEAR(dot(mesh.normals[v], mesh.normals[v]), 1, 1e-5);
    EXPECT_GT(dot(mesh.normals[v], exact[v]), std::cos(0.02)) << v;
  }
}

/// At the corner 0 of a roof, the side along z has three times the area of that along x, in however many triangles.
TEST(VertexNormals, AreWeightedByArea) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_vertex_normals(mesh);
  const double length = std::sqrt(10.0);
  EXPECT_NEAR(mesh.normals[0].z, 3 / length, 1e-6);
  EXPECT_NEAR(mesh.normals[0].x, 1 / length, 1e-6);
  EXPECT_EQ(mesh.normals[1].z, 1);
  EXPECT_EQ(mesh.normals[3].x, 1);
}

TEST(VertexNormals, AreZeroWhereThereIsNoFace) {
  Mesh mesh = test::box_mesh();
  mesh.vertices.push_back({4, 4, 4});
  add_vertex_normals(mesh);
  EXPECT_EQ(mesh.normals.back(), (Vec3f{0, 0, 0}));
  const float third = 1 / std::sqrt(3.0F);
  for (std::size_t v = 0; v < 8; ++v)
    EXPECT_GT(std::abs(mesh.normals[v].x), third / 2) << "every corner of the box faces three ways";
}

TEST(VertexNormals, RefuseATriangleOfVerticesThatDoNotExist) {
  Mesh mesh = test::box_mesh();
  mesh.triangles[0][2] = -1;
  EXPECT_THROW(add_vertex_normals(mesh), Error);
}

}  // namespace
}  // namespace pointskin
