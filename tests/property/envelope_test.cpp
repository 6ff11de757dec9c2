// Surfaces within an envelope: they stay inside of it, closed and manifold, whatever the points do.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu.hpp"
#include "mesh/signed_distance.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::run;

std::shared_ptr<const Mesh> shared(Mesh mesh) { return std::make_shared<const Mesh>(std::move(mesh)); }

/// How far the vertices and the middles of the triangles lie outside of an envelope, at most.
struct Protrusion {
  double vertices = 0, triangles = 0;
};
Protrusion protrusion_of(const Mesh& mesh, const Mesh& envelope) {
  using namespace mesh_detail;
  exec::Cpu ex(1);
  const SignedDistance distance(ex, envelope, envelope.origin - mesh.origin);
  Protrusion worst;
  for (const Vec3f& v : mesh.vertices) worst.vertices = std::max(worst.vertices, -distance.at(to_double(v)).distance);
  for (const Triangle& t : mesh.triangles) {
    Vec3d middle{0, 0, 0};
    for (const std::int32_t v : t) middle += 1.0 / 3 * to_double(mesh.vertices[static_cast<std::size_t>(v)]);
    worst.triangles = std::max(worst.triangles, -distance.at(middle).distance);
  }
  return worst;
}

/// The samples of the unit sphere above z = `bottom`.
Cloud cap_cloud(std::int64_t n, std::uint64_t seed, float bottom) {
  const Cloud sphere = test::sphere_cloud(4 * n, seed);
  Cloud cloud;
  for (std::size_t i = 0; i < sphere.positions.size() && cloud.size() < n; ++i)
    if (sphere.positions[i].z > bottom) {
      cloud.positions.push_back(sphere.positions[i]);
      cloud.normals.push_back(sphere.normals[i]);
    }
  return cloud;
}

struct Case {
  std::string name;
  Cloud cloud;
  Mesh envelope;
  bool presses;  ///< samples lie outside
};
/// Open scans, which leave their envelopes where nothing holds them, and noisy ones in tight envelopes.
std::vector<Case> cases() {
  const Cloud cap = cap_cloud(20'000, 1, 0);
  const Cloud sphere = test::jittered(test::sphere_cloud(30'000, 5), 6, 0.05);
  const Cloud torus = test::jittered(test::torus_cloud(30'000, 7), 8, 0.05);
  Mesh wedge = test::tetrahedron_mesh();
  for (Vec3f& v : wedge.vertices) v = {8 * v.x - 2, 8 * v.y - 2, 8 * v.z - 0.3F};
  return {{"half sphere, box", cap, test::box_mesh({-1.05, -1.05, -0.2}, {1.05, 1.05, 1.05}), false},
          {"half sphere, sphere", cap, test::icosphere_mesh(4, 1.05), false},
          {"half sphere, tetrahedron", cap, wedge, false},
          {"plane, flat box", test::plane_cloud(20'000, 3), test::box_mesh({-1.1, -1.1, -0.3}, {1.1, 1.1, 0.1}), false},
          {"plane, torus", test::plane_cloud(20'000, 4), test::torus_mesh(64, 32, 0.8, 0.3), true},
          {"noisy sphere, sphere", sphere, test::icosphere_mesh(4), true},
          {"noisy sphere, box", sphere, test::box_mesh({-0.9, -0.8, -2}, {1.2, 0.7, 0.6}), true},
          {"noisy torus, torus", torus, test::torus_mesh(96, 48), true}};
}

TEST(Envelope, KeepsTheSurfaceInside) {
  for (const Case& c : cases())
    for (const int depth : {5, 7})
      for (const double scale : {1.1, 2.0}) {
        SCOPED_TRACE(c.name + ", depth " + std::to_string(depth) + ", scale " + std::to_string(scale));
        Options options{{.depth = depth, .scale = scale}};
        const Protrusion without = protrusion_of(run(c.cloud, options).mesh, c.envelope);
        options.envelope = shared(c.envelope);
        const Outcome within = run(c.cloud, options);
        const double cell = scale * 2.1 / (1 << depth);
        if (scale < 2) {
          EXPECT_GT(without.vertices, 0.1 * cell);
        }
        if (c.presses && depth == 5 && scale == 2) {  // coarse cells: the field alone does not stop the surface
          EXPECT_GT(within.report.envelope.vertices_moved, 0);
          EXPECT_GT(within.report.envelope.farthest_move, 0);
        }
        const Protrusion left = protrusion_of(within.mesh, c.envelope);
        EXPECT_LT(left.vertices, 1e-6) << "cells of " << cell;
        EXPECT_LT(left.triangles, 0.1 * cell);
        EXPECT_TRUE(measure(within.mesh).watertight());
      }
}

TEST(Envelope, NoTwoVerticesMeet) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Mesh mesh = run(c.cloud, {{.depth = 6, .envelope = shared(c.envelope)}}).mesh;
    std::set<std::tuple<float, float, float>> places;
    for (const Vec3f& v : mesh.vertices) places.insert({v.x, v.y, v.z});
    EXPECT_EQ(places.size(), mesh.vertices.size());
  }
}

TEST(Envelope, HoldsNoisyPointsBackThatLieOutside) {
  const Cloud noisy = test::jittered(test::sphere_cloud(30'000, 5), 6, 0.05);
  const Mesh tight = test::icosphere_mesh(5, 1.0);
  const Outcome r = run(noisy, {{.depth = 7, .envelope = shared(tight)}});
  EXPECT_TRUE(measure(r.mesh).watertight());
  EXPECT_LT(protrusion_of(r.mesh, tight).vertices, 1e-6);
  EXPECT_GT(r.report.envelope.samples_outside, 10'000);
  EXPECT_LT(r.report.envelope.samples_outside, 20'000);
  EXPECT_GT(measure(r.mesh).volume, 0.9 * measure(tight).volume);
}

TEST(Envelope, FarFromAClosedScanChangesNothingButRounding) {
  for (const auto& [name, cloud] : std::vector<std::pair<std::string, Cloud>>{
           {"sphere", test::sphere_cloud(20'000, 7)}, {"torus", test::torus_cloud(20'000, 8)}}) {
    SCOPED_TRACE(name);
    const Outcome without = run(cloud, {{.depth = 7}});
    const Outcome within = run(cloud, {{.depth = 7, .envelope = shared(test::box_mesh({-3, -3, -3}, {3, 3, 3}))}});
    expect_same_bytes(within.mesh, without.mesh);  // it lies outside of the cube
    EXPECT_EQ(within.report.envelope.vertices_moved, 0);
    EXPECT_EQ(within.report.envelope.samples_outside, 0);

    const Outcome near =
        run(cloud, {{.depth = 7, .envelope = shared(test::box_mesh({-1.42, -1.42, -1.42}, {1.42, 1.42, 1.42}))}});
    EXPECT_EQ(measure(near.mesh).euler, measure(without.mesh).euler);
    EXPECT_EQ(near.report.envelope.vertices_moved, 0);
    EXPECT_LT(compare(near.mesh, without.mesh).two_sided.max, 0.2 * 2.2 / 128);  // of a cell
  }
}

TEST(Envelope, ClosesAScanThatGoesOnOutside) {
  const Mesh box = test::box_mesh({-2, -2, 0.3}, {2, 2, 2});
  const Outcome r = run(test::sphere_cloud(40'000, 9), {{.depth = 7, .envelope = shared(box)}});
  EXPECT_TRUE(measure(r.mesh).watertight());
  EXPECT_NEAR(static_cast<double>(r.report.envelope.samples_outside), 0.65 * 40'000, 1000);
  EXPECT_NEAR(r.report.isovalue, 0.5, 0.05) << "samples outside, where the field is 0, must not count";
  EXPECT_LT(protrusion_of(r.mesh, box).vertices, 1e-6);
  const Bounds bounds = bounds_of(r.mesh.vertices);
  EXPECT_GT(bounds.upper.z, 0.99);
  EXPECT_LT(bounds.lower.z, 0.35);
}

TEST(Envelope, GivesTheSameBytesForAnyThreadsAndOrder) {
  const Case c = cases()[1];
  const Options options{{.depth = 6, .envelope = shared(c.envelope)}};
  const Mesh mesh = run(c.cloud, options, 1).mesh;
  expect_same_bytes(run(c.cloud, options, 3).mesh, mesh);
  expect_same_bytes(run(test::shuffled(c.cloud, 10), options, 2).mesh, mesh);
  const Field field = Reconstructor(Device::cpu(2)).solve(c.cloud, options, {});
  expect_same_bytes(field.extract(), mesh);
  expect_same_bytes(field.extract(), mesh);
}

TEST(Envelope, LiesInWorldCoordinatesWhateverTheOrigins) {
  Case c = cases()[0];
  const Mesh mesh = run(c.cloud, {{.depth = 6, .envelope = shared(c.envelope)}}).mesh;
  c.cloud.origin = {4e6, -5e5, 100};
  c.envelope.origin = {4e6 - 8, -5e5 + 16, 100 - 4};  // exact in float
  c.envelope = test::translated(c.envelope, {8, -16, 4});
  const Mesh moved = run(c.cloud, {{.depth = 6, .envelope = shared(c.envelope)}}).mesh;
  ASSERT_EQ(moved.vertices.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {  // the envelope's floats are coarser there
    ASSERT_NEAR(moved.vertices[i].x, mesh.vertices[i].x, 1e-4);
    ASSERT_NEAR(moved.vertices[i].y, mesh.vertices[i].y, 1e-4);
    ASSERT_NEAR(moved.vertices[i].z, mesh.vertices[i].z, 1e-4);
  }
}

TEST(Envelope, GoesWithOtherOptions) {
  const Case c = cases()[1];
  for (const Options& options : std::vector<Options>{{{.depth = 6, .screening = 0}},
                                                     {{.depth = 6}, {.linear_fit = true}},
                                                     {{.depth = 6}, {.normals = false}},
                                                     {{.depth = 6, .boundary = Boundary::dirichlet}},
                                                     {{.depth = 1}},
                                                     {{.depth = 3}},
                                                     {{.depth = 6}, {.domain_faces = DomainFaces::open}}}) {
    Options with = options;
    with.envelope = shared(c.envelope);
    const std::optional<ErrorCode> error = error_of([&] {
      const Outcome r = run(c.cloud, with);
      EXPECT_TRUE(measure(r.mesh).manifold());
      EXPECT_LT(protrusion_of(r.mesh, c.envelope).vertices, 1e-6);
    });
    EXPECT_TRUE(!error || with.depth == 1);
  }
}

TEST(Envelope, HoldsForTheBorderOfATrimmedSurfaceToo) {
  const Case c = cases()[4];  // a plane in a torus
  const Outcome r = run(c.cloud, {{.depth = 6, .envelope = shared(c.envelope)}, {.trim = 0.3}});
  EXPECT_TRUE(measure(r.mesh).manifold());
  EXPECT_GT(r.report.trim.triangles_split, 0);
  EXPECT_LT(protrusion_of(r.mesh, c.envelope).vertices, 1e-6);
}

TEST(Envelope, RefusesMeshesThatEncloseNothing) {
  const Cloud cloud = test::sphere_cloud(1000, 11);
  Mesh open = test::box_mesh();
  open.triangles.pop_back();
  Mesh twisted = test::box_mesh();
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  Mesh twice = test::box_mesh();
  test::append(twice, test::box_mesh());
  for (Triangle& t : twice.triangles)
    for (std::int32_t& v : t) v %= 8;
  Mesh infinite = test::box_mesh();
  infinite.vertices[3].y = INFINITY;
  Mesh astray = test::box_mesh();
  astray.triangles[5][1] = 8;
  for (const Mesh& bad : {Mesh{}, open, twisted, twice, infinite, astray, test::flipped(test::box_mesh()),
                          test::patch_mesh(3), test::moebius_mesh(5)})
    EXPECT_EQ(error_of([&] { run(cloud, {{.depth = 4, .envelope = shared(bad)}}); }), ErrorCode::invalid_input);
}

TEST(Envelope, FailsWhereAllPointsLieOutside) {
  EXPECT_EQ(
      error_of([] {
        run(test::sphere_cloud(1000, 12), {{.depth = 5, .envelope = shared(test::box_mesh({5, 5, 5}, {6, 6, 6}))}});
      }),
      ErrorCode::empty_result);
}

TEST(Envelope, FailsWhereItIsNarrowerThanTheCells) {
  // One corner of the octree is inside, the middle of the cube, where many points are.
  Cloud cloud = test::sphere_cloud(1000, 13);
  for (int i = 0; i < 1000; ++i) {
    cloud.positions.push_back({0, 0, 0});
    cloud.normals.push_back({0, 0, 1});
  }
  const Mesh box = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  const auto within = [&](float half_width) {
    Mesh envelope = box;
    for (Vec3f& v : envelope.vertices) v = {half_width * v.x, half_width * v.y, half_width * v.z};
    return error_of(
        [&] { EXPECT_GT(measure(run(cloud, {{.depth = 4, .envelope = shared(envelope)}}).mesh).volume, 0); });
  };
  EXPECT_EQ(within(0.5F), std::nullopt);
  EXPECT_EQ(within(0.005F), ErrorCode::empty_result);
}

TEST(Envelope, HoldsPointsOnADevice) {
  const Case c = cases()[1];
  Reconstructor r(Device::cpu(2));
  const Options options{{.depth = 6, .envelope = shared(c.envelope)}};
  const UploadedCloud points = upload(r.workspace(), c.cloud);
  expect_same_bytes(download(r.workspace(), r.reconstruct(points, options)), r.reconstruct(c.cloud, options));
}

}  // namespace
}  // namespace pointskin
