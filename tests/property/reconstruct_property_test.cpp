// What every reconstruction must be, whatever the cloud: watertight, of the right topology, and the same bytes every
// time.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::axes_rotated;
using test::expect_same_bytes;
using test::flipped;
using test::reconstructed;
using test::scaled;
using test::shuffled;
using test::translated;

struct ShapeCase {
  std::string name;
  Cloud cloud;
  std::int64_t components;
  std::int64_t euler;
  int coarsest, finest;  ///< depths that resolve the shape
};

std::vector<ShapeCase> shapes() {
  std::vector<ShapeCase> cases;
  cases.push_back({"sphere", test::sphere_cloud(20'000, 1), 1, 2, 3, 8});
  cases.push_back({"torus", test::torus_cloud(30'000, 2), 1, 0, 5, 8});
  cases.push_back({"linked tori", test::linked_tori_cloud(40'000, 3), 2, 0, 6, 8});
  cases.push_back({"box", test::box_cloud(30'000, 4), 1, 2, 3, 8});
  cases.push_back({"thin plate", test::thin_plate_cloud(40'000, 5, 0.12), 1, 2, 7, 8});
  cases.push_back({"two spheres", test::two_spheres_cloud(40'000, 6, 0.25), 2, 4, 7, 8});
  return cases;
}

TEST(Reconstruct, IsWatertightAndHasTheShapesTopology) {
  for (const ShapeCase& shape : shapes())
    for (int depth = shape.coarsest; depth <= shape.finest; ++depth) {
      const MeshReport report = measure(reconstructed(shape.cloud, {{.depth = depth}}));
      SCOPED_TRACE(shape.name + ", depth " + std::to_string(depth));
      EXPECT_TRUE(report.watertight());
      EXPECT_EQ(report.components, shape.components);
      EXPECT_EQ(report.euler, shape.euler);
      EXPECT_EQ(report.vertices, report.used_vertices);
    }
}

TEST(Reconstruct, IsWatertightWithAnyOptions) {
  const Cloud cloud = test::torus_cloud(5'000, 7);
  std::vector<Options> all;
  for (const double screening : {0.0, 0.5, 100.0}) all.push_back({{.depth = 6, .screening = screening}});
  for (const int iterations : {1, 3, 50}) all.push_back({{.depth = 6, .iterations = iterations}});
  for (const double scale : {1.0, 1.01, 2.5}) all.push_back({{.depth = 6, .scale = scale}});
  for (const double samples : {0.0, 10.0, 100.0}) all.push_back({{.depth = 6, .samples_per_node = samples}});
  all.push_back({{.depth = 7}, {.linear_fit = true}});
  all.push_back({{.depth = 7}, {.normals = false}});
  all.push_back({{.depth = 9, .screening = 4, .iterations = 4, .scale = 1.3, .samples_per_node = 0}});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Mesh mesh = reconstructed(cloud, all[i]);
    EXPECT_TRUE(measure(mesh).watertight()) << "options number " << i;
    EXPECT_EQ(mesh.normals.size(), all[i].normals ? mesh.vertices.size() : 0);
  }
}

double worst_radius_error(const Mesh& mesh) {
  double worst = 0;
  for (const Vec3f& v : mesh.vertices) worst = std::max(worst, std::abs(std::hypot(v.x, v.y, v.z) - 1.0));
  return worst;
}

TEST(Reconstruct, ComesCloserToASphereWithDepth) {
  const Cloud cloud = test::sphere_cloud(50'000, 8);
  for (const bool linear_fit : {false, true})
    for (int depth = 5; depth <= 7; ++depth) {
      const Mesh mesh = reconstructed(cloud, {{.depth = depth}, {.linear_fit = linear_fit}});
      const double cell = 2.2 / (1 << depth);
      EXPECT_LT(worst_radius_error(mesh), 0.25 * cell) << "depth " << depth;  // far below a cell
      const MeshReport report = measure(mesh);
      EXPECT_NEAR(report.volume, 4 * std::numbers::pi / 3, 0.1 * cell * report.area);
    }
}

TEST(Reconstruct, GivesNormalsThatPointAwayFromASpheresCentre) {
  const Mesh mesh = reconstructed(test::sphere_cloud(20'000, 9), {{.depth = 6}});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3f& v = mesh.vertices[i];
    const Vec3f& n = mesh.normals[i];
    ASSERT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-5);
    ASSERT_GT((v.x * n.x + v.y * n.y + v.z * n.z) / std::hypot(v.x, v.y, v.z), 0.95);
  }
}

// ---- Determinism

TEST(Reconstruct, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const ShapeCase& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const Mesh one = reconstructed(shape.cloud, {{.depth = 7}, {.density = true}}, 1);
    expect_same_bytes(one, reconstructed(shape.cloud, {{.depth = 7}, {.density = true}}, 2));
    expect_same_bytes(one, reconstructed(shape.cloud, {{.depth = 7}, {.density = true}}, 16));
  }
}

TEST(Reconstruct, GivesTheSameBytesForAnyOrderOfThePoints) {
  for (const ShapeCase& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const Mesh expected = reconstructed(shape.cloud, {{.depth = 6}});
    for (const std::uint64_t seed : {1, 2})
      expect_same_bytes(expected, reconstructed(shuffled(shape.cloud, seed), {{.depth = 6}}));
  }
}

TEST(Reconstruct, GivesTheSameBytesForAnyOrderOfRepeatedPoints) {
  Cloud cloud = test::sphere_cloud(3'000, 10);
  test::append(cloud, test::sphere_cloud(2'000, 10));  // the first 2000 may appear again
  Cloud conflicting = cloud;
  for (std::size_t i = 0; i < 500; ++i) {  // same place, other normal: only the hash of all data can order them
    conflicting.positions.push_back(cloud.positions[i]);
    conflicting.normals.push_back({cloud.normals[i].y, cloud.normals[i].z, cloud.normals[i].x});
  }
  for (const Cloud* c : {&cloud, &conflicting}) {
    const Mesh expected = reconstructed(*c, {{.depth = 6}});
    for (const std::uint64_t seed : {3, 4, 5})
      expect_same_bytes(expected, reconstructed(shuffled(*c, seed), {{.depth = 6}}));
  }
}

TEST(Reconstruct, GivesTheSameBytesRunAfterRunFromOneReconstructor) {
  Reconstructor r(Device::cpu(2));
  const Cloud sphere = test::sphere_cloud(10'000, 11);
  const Cloud torus = test::torus_cloud(20'000, 12);
  const Mesh first = r.reconstruct(sphere, {{.depth = 7}});
  const Mesh other = r.reconstruct(torus, {{.depth = 6}});
  EXPECT_THROW((void)r.reconstruct(Cloud{}), Error);  // a failed run leaves nothing behind
  expect_same_bytes(first, r.reconstruct(sphere, {{.depth = 7}}));
  expect_same_bytes(other, r.reconstruct(torus, {{.depth = 6}}));
}

TEST(Reconstruct, RunsSideBySideInTwoReconstructorsAndTheirFieldsOutliveThem) {
  const Cloud sphere = test::sphere_cloud(5'000, 13);
  const Cloud torus = test::torus_cloud(5'000, 14);
  auto a = std::make_unique<Reconstructor>(Device::cpu(1));
  auto b = std::make_unique<Reconstructor>(Device::cpu(2));
  const Field field_a = a->solve(sphere, {.depth = 6});
  const Field field_b = b->solve(torus, {.depth = 6});
  const Mesh mesh_a = a->reconstruct(sphere, {{.depth = 6}});
  a.reset();
  b.reset();
  expect_same_bytes(field_a.extract(), mesh_a);
  EXPECT_EQ(measure(field_b.extract()).euler, 0);
}

// ---- Other frames

TEST(Reconstruct, TurnsWithTheAxes) {
  const Cloud cloud = test::linked_tori_cloud(30'000, 15);
  const MeshReport expected = measure(reconstructed(cloud, {{.depth = 7}}));
  Cloud turned = cloud;
  for (int i = 0; i < 2; ++i) {
    turned = axes_rotated(turned);
    const MeshReport report = measure(reconstructed(turned, {{.depth = 7}}));
    EXPECT_EQ(report.components, expected.components);
    EXPECT_EQ(report.euler, expected.euler);
    EXPECT_NEAR(report.volume, expected.volume, 1e-3 * expected.volume);
    EXPECT_NEAR(report.area, expected.area, 1e-3 * expected.area);
  }
}

TEST(Reconstruct, MovesWithTheOriginBitForBit) {
  Cloud cloud = test::torus_cloud(10'000, 16);
  const Mesh expected = reconstructed(cloud, {{.depth = 7}});
  cloud.origin = {4.5e6, -3.25e5, 1000.125};
  const Mesh moved = reconstructed(cloud, {{.depth = 7}});
  EXPECT_EQ(moved.origin, cloud.origin);
  expect_same_bytes(expected, moved);
}

TEST(Reconstruct, ScalesWithPowersOfTwoWithTheSameTopology) {
  const Cloud cloud = test::torus_cloud(10'000, 17);
  const Mesh expected = reconstructed(cloud, {{.depth = 7}});
  for (const float factor : {0x1p-20F, 0x1p-3F, 0x1p+20F}) {
    const Mesh mesh = reconstructed(scaled(cloud, factor), {{.depth = 7}});
    ASSERT_EQ(mesh.triangles, expected.triangles) << factor;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      ASSERT_EQ(mesh.vertices[i].x, expected.vertices[i].x * factor) << factor;
  }
}

TEST(Reconstruct, ScalesWithOtherFactorsAndMovesInFloat) {
  const Cloud cloud = test::torus_cloud(10'000, 18);
  const auto expected = static_cast<double>(measure(reconstructed(cloud, {{.depth = 7}})).triangles);
  std::vector<Cloud> others = {scaled(cloud, 1e-6F), scaled(cloud, 1e6F), translated(cloud, {1000, -2000, 500})};
  for (std::size_t i = 0; i < others.size(); ++i) {
    const MeshReport report = measure(reconstructed(others[i], {{.depth = 7}}));
    EXPECT_TRUE(report.watertight()) << i;
    EXPECT_EQ(report.euler, 0) << i;
    const double tolerance = i == 2 ? 0.02 : 0.001;  // positions near 2000 keep 2^-13 of a unit: 1/140 of a cell
    EXPECT_NEAR(static_cast<double>(report.triangles), expected, tolerance * expected) << i;
  }
}

TEST(Reconstruct, TurnsInsideOutWithTheNormalsThatAreGiven) {
  // The outside of flipped normals is the ball: the solid is the rest of the cube, capped at its faces.
  const Cloud cloud = test::sphere_cloud(10'000, 19);
  const MeshReport report =
      measure(reconstructed(flipped(cloud), {{.depth = 6, .point_normals = PointNormals::given}}));
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.euler, 4);
  // Leaves at the cube's 12 edges are 1/16 of it wide; the cap bevels them.
  const double size = 2.2;
  const double bevels = 12 * size * std::pow(size / 16, 2) / 2;
  EXPECT_NEAR(report.volume, std::pow(size, 3) - 4 * std::numbers::pi / 3 - bevels / 2, 0.75 * bevels);
}

}  // namespace
}  // namespace pointskin
