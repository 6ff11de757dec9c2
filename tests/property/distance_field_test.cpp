// Signed distance as the field: closed surfaces through the samples, on every shape; borders; options.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::reconstructed;

Options distance_options(int depth) {
  Options options{{.depth = depth}};
  options.field = FieldKind::distance;
  return options;
}

struct Expected {
  std::string name;
  Cloud cloud;
  std::int64_t components, euler;
};

std::vector<Expected> shapes() {
  return {{"sphere", test::sphere_cloud(20'000, 1), 1, 2},
          {"few points", test::sphere_cloud(500, 2), 1, 2},
          {"torus", test::torus_cloud(20'000, 3), 1, 0},
          {"linked tori", test::linked_tori_cloud(30'000, 4), 2, 0},
          {"box", test::box_cloud(20'000, 5), 1, 2},
          {"thin plate", test::thin_plate_cloud(30'000, 6, 0.1), 1, 2},
          {"two spheres", test::two_spheres_cloud(20'000, 7, 0.3), 2, 4}};
}

TEST(DistanceField, GivesOneClosedSurfaceForEveryShape) {
  for (const Expected& e : shapes())
    for (const int depth : {5, 7, 8}) {
      SCOPED_TRACE(e.name + ", depth " + std::to_string(depth));
      const MeshReport measured = measure(reconstructed(e.cloud, distance_options(depth)));
      EXPECT_TRUE(measured.closed());
      EXPECT_TRUE(measured.manifold());
      EXPECT_EQ(measured.components, e.components);
      EXPECT_EQ(measured.euler, e.euler);
    }
}

/// 20,000 points of a torus, and `count` anywhere in its box that face any way.
Cloud torus_among_outliers(int count) {
  Cloud cloud = test::torus_cloud(20'000, 19);
  test::Random random(20);
  const auto anywhere = [&](double lower, double upper) { return static_cast<float>(random.in(lower, upper)); };
  for (int i = 0; i < count; ++i) {
    const Vec3d n = random.direction();
    cloud.positions.push_back({anywhere(-1.3, 1.3), anywhere(-1.3, 1.3), anywhere(-0.8, 0.8)});
    cloud.normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
  }
  return cloud;
}

TEST(DistanceField, GivesOneSurfaceAmongOutliers) {
  for (const int outliers : {20, 200, 1000}) {
    SCOPED_TRACE(outliers);
    const MeshReport measured = measure(reconstructed(torus_among_outliers(outliers), distance_options(7)));
    EXPECT_TRUE(measured.closed());
    EXPECT_TRUE(measured.manifold());
    EXPECT_EQ(measured.components, 1);
    EXPECT_EQ(measured.euler, 0);
  }
}

TEST(DistanceField, OfASphereIsItsSignedDistanceInCells) {
  const Cloud cloud = test::sphere_cloud(100'000, 8);
  const Options options = distance_options(7);
  const Field field = Reconstructor(Device::cpu(2)).solve(cloud, options, {});
  EXPECT_EQ(field.isovalue(), 0);
  const double cell = field.cube_size_world() / 128;
  test::expect_distance_to_unit_sphere(field, 1, 2 * cell, cell);
}

TEST(DistanceField, PassesThroughCleanSamples) {
  for (const int depth : {6, 7}) {
    const Outcome outcome = test::run(test::sphere_cloud(100'000, 10), distance_options(depth));
    const double cell = 2.2 / std::pow(2.0, depth);
    for (const Vec3f& v : outcome.mesh.vertices) ASSERT_NEAR(std::hypot(v.x, v.y, v.z), 1, 0.1 * cell);
    for (std::size_t i = 0; i < outcome.mesh.vertices.size(); ++i) {
      const Vec3f v = outcome.mesh.vertices[i], n = outcome.mesh.normals[i];
      ASSERT_GT(v.x * n.x + v.y * n.y + v.z * n.z, 0.95);
    }
    ASSERT_EQ(outcome.report.levels.size(), static_cast<std::size_t>(depth) + 1);
    for (const LevelReport& level : outcome.report.levels) {
      EXPECT_GT(level.nodes, 0);
      EXPECT_GT(level.iterations, 0);
    }
  }
}

TEST(DistanceField, DoesNotDependOnThreadsOrOrder) {
  Options options = distance_options(6);
  options.density = true;
  options.confidence = true;
  const Cloud cloud = test::jittered(test::torus_cloud(8'000, 11), 12, 0.01);
  const Mesh once = reconstructed(cloud, options, 1);
  expect_same_bytes(once, reconstructed(cloud, options, 3));
  expect_same_bytes(once, reconstructed(test::shuffled(cloud, 13), options));
}

TEST(AmongOutliers, MeshesDoNotDependOnThreadsOrOrder) {
  const Cloud cloud = torus_among_outliers(2000);
  for (const FieldKind field : {FieldKind::poisson, FieldKind::distance}) {
    Options options{{.depth = 6}};
    options.field = field;
    const Mesh once = reconstructed(cloud, options, 1);
    for (int run = 0; run < 3; ++run) expect_same_bytes(once, reconstructed(cloud, options, 4));
    expect_same_bytes(once, reconstructed(test::shuffled(cloud, 22), options));
  }
}

TEST(DistanceField, IsTrimmedWhereSamplesEnd) {
  const Cloud cloud = test::plane_cloud(20'000, 14);
  Options options = distance_options(6);
  EXPECT_TRUE(measure(reconstructed(cloud, options)).closed());  // capped at the cube's faces
  options.domain_faces = DomainFaces::open;
  EXPECT_FALSE(measure(reconstructed(cloud, options)).closed());
  options.domain_faces = DomainFaces::closed;
  options.trim = 0.05;
  const Outcome trimmed = test::run(cloud, options);
  const MeshReport measured = measure(trimmed.mesh);
  EXPECT_TRUE(measured.manifold());
  EXPECT_EQ(measured.components, 1);
  EXPECT_NEAR(measured.area, 4, 0.5);
  for (const Vec3f& v : trimmed.mesh.vertices) ASSERT_NEAR(v.z, 0, 1e-4);
}

TEST(DistanceField, KeepsAttributesInTheirRange) {
  Cloud cloud = test::sphere_cloud(5'000, 15);
  cloud.attributes = {test::attribute_of<float>("height", cloud.positions, [](const Vec3f& p) { return p.z; })};
  Options options = distance_options(6);
  options.attributes = true;
  const Mesh mesh = reconstructed(cloud, options);
  ASSERT_EQ(mesh.attributes.size(), 1U);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_NEAR(mesh.attributes[0].values.at(i), mesh.vertices[i].z, 0.05);
}

TEST(DistanceField, ShortNormalsCountLessWithConfidence) {
  Cloud cloud = test::sphere_cloud(20'000, 16);
  Cloud doubtful = test::sphere_cloud(20'000, 17, 1.03);
  for (Vec3f& n : doubtful.normals) n = {0.01F * n.x, 0.01F * n.y, 0.01F * n.z};
  test::append(cloud, doubtful);
  Options options = distance_options(5);
  const auto off = [&] { return std::abs(measure(reconstructed(cloud, options)).volume - 4.18879); };
  const double without = off();
  options.confidence = true;
  EXPECT_LT(off(), 0.5 * without);
}

TEST(DistanceField, RefusesOptionsThatNeedASolve) {
  const Cloud cloud = test::sphere_cloud(500, 18);
  Options options = distance_options(4);
  options.boundary = Boundary::dirichlet;
  EXPECT_EQ(error_of([&] { (void)reconstructed(cloud, options); }), ErrorCode::usage);
  options = distance_options(4);
  options.envelope = std::make_shared<const Mesh>(test::box_mesh({-2, -2, -2}, {2, 2, 2}));
  EXPECT_EQ(error_of([&] { (void)reconstructed(cloud, options); }), ErrorCode::usage);
  options = distance_options(4);
  options.weakness = true;
  EXPECT_EQ(error_of([&] { (void)reconstructed(cloud, options); }), ErrorCode::usage);
}

TEST(DistanceField, TakesTheMemoryThatIsEstimated) {
  for (const int depth : {5, 7, 8})
    for (const bool extras : {false, true}) {
      SCOPED_TRACE("depth " + std::to_string(depth) + (extras ? ", with density and confidence" : ""));
      Options options = distance_options(depth);
      options.density = options.confidence = extras;
      options.trim = extras ? 0.05 : 0;
      for (const std::int64_t n : {2'000, 60'000}) {
        const Cloud cloud = test::torus_cloud(n, 19);
        const auto estimate = static_cast<double>(estimate_device_bytes(cloud, options, 2));
        const auto peak = static_cast<double>(test::run(cloud, options).report.device_peak_bytes);
        EXPECT_GT(estimate, 0.85 * peak);
        EXPECT_LT(estimate, 1.15 * peak);
      }
    }
}

/// Planes of opposed points at one place cancel, and the field is flat around them.
TEST(DistanceField, HasNormalsOfUnitLengthWherePlanesCancel) {
  Cloud opposed = test::sphere_cloud(600, 23);
  const std::size_t n = opposed.positions.size();
  for (std::size_t i = 0; i < n; ++i) {
    opposed.positions.push_back(opposed.positions[i]);
    opposed.normals.push_back(-opposed.normals[i]);
  }
  Cloud corners;
  for (int k = 0; k < 8; ++k) {
    const Vec3f p{k & 1 ? 1.0F : -1.0F, k & 2 ? 1.0F : -1.0F, k & 4 ? 1.0F : -1.0F};
    corners.positions.push_back(p);
    corners.normals.push_back(p / std::sqrt(3.0F));
  }
  for (const Cloud* cloud : {&opposed, &corners}) {
    Options options = distance_options(6);
    options.point_normals = PointNormals::given;
    for (const Vec3f& normal : reconstructed(*cloud, options).normals)
      EXPECT_NEAR(std::sqrt(squared_length(normal)), 1, 1e-5);
  }
}

}  // namespace
}  // namespace pointskin
