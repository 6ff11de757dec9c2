#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <cmath>
#include <cstring>
#include <numbers>

#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::box_mesh;
using test::icosphere_mesh;
using test::tetrahedron_mesh;
using test::torus_mesh;

constexpr double kPi = std::numbers::pi;

TEST(Measure, CountsATetrahedron) {
  const MeshReport report = measure(tetrahedron_mesh());
  EXPECT_EQ(report.vertices, 4);
  EXPECT_EQ(report.used_vertices, 4);
  EXPECT_EQ(report.triangles, 4);
  EXPECT_EQ(report.edges, 6);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
  EXPECT_DOUBLE_EQ(report.volume, 1.0 / 6);
  EXPECT_DOUBLE_EQ(report.area, 3 * 0.5 + std::sqrt(3.0) / 2);
  EXPECT_TRUE(report.watertight());
}

TEST(Measure, FindsVolumeOneAndAreaSixOnTheUnitCube) {
  const MeshReport report = measure(box_mesh());
  EXPECT_EQ(report.edges, 12 + 6);  // each side adds its diagonal
  EXPECT_EQ(report.euler, 2);
  EXPECT_DOUBLE_EQ(report.volume, 1);
  EXPECT_DOUBLE_EQ(report.area, 6);
  EXPECT_TRUE(report.watertight());
}

TEST(Measure, GivesATorusEulerNumberZero) {
  const MeshReport report = measure(torus_mesh(64, 32, 1, 0.35));
  EXPECT_EQ(report.triangles, 2 * 64 * 32);
  EXPECT_EQ(report.edges, 3 * 64 * 32);
  EXPECT_EQ(report.euler, 0);
  EXPECT_EQ(report.components, 1);
  EXPECT_TRUE(report.watertight());
  // The cross-section is a 32-gon, swept by 64 steps: both fall short of the circle by O(1/n^2), below 1.5 % together.
  EXPECT_NEAR(report.volume, 2 * kPi * kPi * 0.35 * 0.35, 0.015 * 2 * kPi * kPi * 0.35 * 0.35);
}

TEST(Measure, CountsComponentsBySharedVertices) {
  Mesh mesh = box_mesh();
  test::append(mesh, box_mesh({2, 0, 0}, {3, 1, 1}));
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.euler, 4);
  EXPECT_DOUBLE_EQ(report.volume, 2);
  EXPECT_TRUE(report.watertight());
}

TEST(Measure, SeesTheFourEdgesAroundAMissingSide) {
  Mesh mesh = box_mesh();
  mesh.triangles.resize(mesh.triangles.size() - 2);  // a side is two triangles next to each other
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.boundary_edges, 4);
  EXPECT_EQ(report.edges, 18 - 1);  // the diagonal went with its side
  EXPECT_EQ(report.euler, 1);       // a disc
  EXPECT_FALSE(report.closed());
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, FindsTheOneEdgeWhereAMoebiusStripTurnsOver) {
  const MeshReport report = measure(test::moebius_mesh(12));
  EXPECT_EQ(report.misoriented_edges, 1);
  EXPECT_EQ(report.boundary_edges, 2 * 12);
  EXPECT_EQ(report.euler, 0);
  EXPECT_EQ(report.components, 1);
  EXPECT_TRUE(report.manifold());
  EXPECT_FALSE(report.oriented());
}

TEST(Measure, FindsTheVertexThatTwoTetrahedraShare) {
  Mesh mesh = tetrahedron_mesh();
  mesh.vertices.insert(mesh.vertices.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  // The mirror image through the origin, which turns triangles over.
  mesh.triangles.insert(mesh.triangles.end(), {{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.non_manifold_vertices, 1);
  EXPECT_EQ(report.non_manifold_edges, 0);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 3);
  EXPECT_DOUBLE_EQ(report.volume, 2.0 / 6);
  EXPECT_TRUE(report.closed());
  EXPECT_TRUE(report.oriented());
  EXPECT_FALSE(report.manifold());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, FindsTheEdgeThatTwoTetrahedraShare) {
  Mesh mesh = tetrahedron_mesh();
  // The mirror image through the z axis, a half turn, which keeps 0 and 3.
  mesh.vertices.insert(mesh.vertices.end(), {{-1, 0, 0}, {0, -1, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 5, 4}, {0, 4, 3}, {0, 3, 5}, {4, 5, 3}});
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1);
  EXPECT_EQ(report.boundary_edges, 0);
  EXPECT_EQ(report.misoriented_edges, 0);
  EXPECT_EQ(report.edges, 6 + 5);
  EXPECT_EQ(report.components, 1);
  EXPECT_FALSE(report.closed());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, FindsTheThreeEdgesOfAFlippedTriangle) {
  Mesh mesh = box_mesh();
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.misoriented_edges, 3);
  EXPECT_TRUE(report.closed());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, CallsAMeshTurnedInsideOutNotWatertight) {
  const MeshReport report = measure(test::flipped(box_mesh()));
  EXPECT_DOUBLE_EQ(report.volume, -1);
  EXPECT_TRUE(report.closed());
  EXPECT_TRUE(report.oriented());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, FindsNothingInAnEmptyMesh) {
  const MeshReport report = measure(Mesh{});
  EXPECT_EQ(report.vertices, 0);
  EXPECT_EQ(report.edges, 0);
  EXPECT_EQ(report.components, 0);
  EXPECT_EQ(report.euler, 0);
  EXPECT_EQ(report.volume, 0);
  EXPECT_FALSE(report.closed());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, LeavesUnusedVerticesOutOfTheEulerNumber) {
  Mesh mesh = box_mesh();
  mesh.vertices.push_back({1e6F, 1e6F, 1e6F});
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.vertices, 9);
  EXPECT_EQ(report.used_vertices, 8);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
  EXPECT_DOUBLE_EQ(report.volume, 1);
}

TEST(Measure, CountsATriangleThatNamesAVertexTwice) {
  Mesh mesh = tetrahedron_mesh();
  mesh.vertices.push_back({5, 5, 5});
  mesh.triangles.push_back({0, 0, 4});
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.degenerate_triangles, 1);
  EXPECT_EQ(report.edges, 6);          // it has no edges of its own
  EXPECT_EQ(report.used_vertices, 5);  // but it uses and connects its vertices
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 5 - 6 + 5);
  EXPECT_FALSE(report.manifold());
  EXPECT_FALSE(report.watertight());
}

TEST(Measure, CountsATriangleListedTwiceAsMisoriented) {
  Mesh mesh = tetrahedron_mesh();
  mesh.triangles = {{0, 1, 2}, {0, 1, 2}};
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.edges, 3);
  EXPECT_EQ(report.misoriented_edges, 3);
  EXPECT_EQ(report.used_vertices, 3);
}

TEST(Measure, RejectsAnIndexOutOfRange) {
  for (const std::int32_t bad : {-1, 4, 2'000'000'000}) {
    Mesh mesh = tetrahedron_mesh();
    mesh.triangles[2][1] = bad;
    try {
      measure(mesh);
      FAIL() << "accepted vertex " << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_NE(std::strstr(error.what(), "triangle 2"), nullptr) << error.what();
    }
  }
}

TEST(Measure, RejectsANegativeNumberOfThreads) { EXPECT_THROW(measure(tetrahedron_mesh(), -1), Error); }

TEST(Measure, KeepsTheVolumeOfABoxFarFromTheOrigin) {
  // Every coordinate is a multiple of 2^-3 below 2^21: exact in float. About the origin the terms would reach 1e18.
  const MeshReport report = measure(box_mesh({1e6, 1e6, 1e6}, {1e6 + 0.5, 1e6 + 0.5, 1e6 + 0.5}));
  EXPECT_NEAR(report.volume, 0.125, 1e-15);
  EXPECT_NEAR(report.area, 1.5, 1e-14);
}

TEST(Measure, ApproachesTheVolumeOfASphereWithTheSquareOfTheEdge) {
  const double exact = 4.0 / 3 * kPi;
  const double coarse = exact - measure(icosphere_mesh(3)).volume;
  const double fine = exact - measure(icosphere_mesh(4)).volume;
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

TEST(Measure, HandlesAVertexSharedByManyTriangles) {
  // A cone over n points: the tip has one fan of n triangles, the border n edges.
  constexpr std::int32_t kSides = 20000;
  Mesh mesh;
  mesh.vertices.push_back({0, 0, 1});
  for (std::int32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * kPi * i / kSides;
    mesh.vertices.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSides});
  }
  const MeshReport report = measure(mesh);
  EXPECT_EQ(report.boundary_edges, kSides);
  EXPECT_EQ(report.non_manifold_vertices, 0);
  EXPECT_EQ(report.euler, 1);
}

TEST(Measure, GivesTheSameBitsForAnyNumberOfThreads) {
  Mesh mesh = torus_mesh(200, 100);
  test::append(mesh, icosphere_mesh(4, 0.2));
  const MeshReport one = measure(mesh, 1);
  for (const int threads : {2, 5}) {
    const MeshReport many = measure(mesh, threads);
    EXPECT_EQ(many.volume, one.volume) << threads;
    EXPECT_EQ(many.area, one.area) << threads;
    EXPECT_EQ(many.components, one.components) << threads;
    EXPECT_EQ(many.edges, one.edges) << threads;
    EXPECT_EQ(many.euler, one.euler) << threads;
  }
}

}  // namespace
}  // namespace pointskin
