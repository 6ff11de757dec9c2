// Offset surfaces: right to half a cell against exact distances, closed, of the topology that the distance says.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu.hpp"
#include "mesh/signed_distance.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::reconstructed;

Options offset_options(int depth, double offset, FieldKind field = FieldKind::poisson) {
  Options options{{.depth = depth}};
  options.field = field;
  options.offset = offset;
  return options;
}

/// Exact signed distance to a shape, positive outside.
using Distance = std::function<double(const Vec3d&)>;

double length(const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); }

double to_box(const Vec3d& p) {  // [-1, 1]^3
  Vec3d out{};
  double inner = -1e300;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::abs(p[a]) - 1;
    out[a] = std::max(off, 0.0);
    inner = std::max(inner, off);
  }
  return inner > 0 ? length(out) : inner;
}

double to_torus(const Vec3d& p) { return std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - 0.35; }

/// Farthest that a vertex is from where it should be, in finest cells of the offset's cube.
double worst_in_cells(const Outcome& outcome, double offset, const Distance& distance) {
  const double cell = std::abs(offset / outcome.report.offset.cells);
  double worst = 0;
  for (const Vec3f& v : outcome.mesh.vertices)
    worst = std::max(worst, std::abs(distance({v.x, v.y, v.z}) - offset) / cell);
  return worst;
}

/// In the log of the test, for docs/decisions/0020.
void print_measured(const std::string& name, const Options& options, const OffsetReport& offset, double worst) {
  std::cout << "[ MEASURED ] " << name << (options.field == FieldKind::distance ? ", distance" : ", poisson")
            << ", depth " << options.depth << ", " << offset.cells << " cells, cube x " << offset.cube_growth
            << ": worst " << worst << " cells, " << offset.ms << " ms\n";
}

void expect_offset(const std::string& name, const Cloud& cloud, const Options& options, const Distance& distance,
                   std::int64_t components, std::int64_t euler) {
  SCOPED_TRACE(name + ", depth " + std::to_string(options.depth) + ", offset " + std::to_string(options.offset) +
               (options.field == FieldKind::distance ? ", distance" : ", poisson"));
  const Outcome outcome = test::run(cloud, options);
  const MeshReport measured = measure(outcome.mesh);
  EXPECT_TRUE(measured.closed());
  EXPECT_TRUE(measured.manifold());
  EXPECT_EQ(measured.components, components);
  EXPECT_EQ(measured.euler, euler);
  const double worst = worst_in_cells(outcome, options.offset, distance);
  EXPECT_LE(worst, 0.5);
  EXPECT_GE(outcome.report.offset.cube_growth, 1);
  EXPECT_GT(outcome.report.offset.band_cells, 0);
  EXPECT_FLOAT_EQ(static_cast<float>(outcome.report.isovalue), static_cast<float>(-outcome.report.offset.cells));
  print_measured(name, options, outcome.report.offset, worst);
}

class OffsetOfASphere : public testing::TestWithParam<int> {};

TEST_P(OffsetOfASphere, HasItsRadiusToHalfACell) {
  const int depth = GetParam();
  const Cloud cloud = test::sphere_cloud(100'000, 1);
  const double cell = 2.2 / std::pow(2.0, depth);
  const Distance distance = [](const Vec3d& p) { return length(p) - 1; };
  for (const double d : depth == 8 ? std::vector<double>{0.25} : std::vector<double>{cell, 4 * cell, 0.25, 0.5})
    for (const double sign : {1.0, -1.0})
      expect_offset("sphere", cloud, offset_options(depth, sign * d), distance, 1, 2);
  if (depth == 8) return;  // takes long
  expect_offset("sphere", cloud, offset_options(depth, 0.1, FieldKind::distance), distance, 1, 2);
}

INSTANTIATE_TEST_SUITE_P(Depths, OffsetOfASphere, testing::Values(6, 7, 8));

/// How many of the box's three slabs a point lies outside of: 1 beyond a face, 2 beyond an edge, 3 beyond a corner.
int slabs_outside(const Vec3f& v) { return (std::abs(v.x) > 1) + (std::abs(v.y) > 1) + (std::abs(v.z) > 1); }

TEST(Offset, OfABoxIsRoundOutsideAndSharpInside) {
  // Fields cut the box's corners, so beyond these the offset is measured to the surface itself.
  const Cloud cloud = test::box_cloud(100'000, 2);
  exec::Cpu ex(2);
  for (const FieldKind field : {FieldKind::poisson, FieldKind::distance}) {
    expect_offset("box", cloud, offset_options(6, -0.3, field), to_box, 1, 2);
    const Mesh surface = reconstructed(cloud, offset_options(6, 0, field));
    const mesh_detail::SignedDistance to_surface(ex, surface, {0, 0, 0});
    const Options options = offset_options(6, 0.3, field);
    const Outcome outcome = test::run(cloud, options);
    const double cell = options.offset / outcome.report.offset.cells;
    double worst[4] = {}, worst_to_surface = 0;
    for (const Vec3f& v : outcome.mesh.vertices) {
      double& at_feature = worst[slabs_outside(v)];
      at_feature = std::max(at_feature, std::abs(to_box({v.x, v.y, v.z}) - options.offset) / cell);
      const double found = -to_surface.at({v.x, v.y, v.z}).distance;
      worst_to_surface = std::max(worst_to_surface, std::abs(found - options.offset) / cell);
    }
    EXPECT_LE(worst_to_surface, 0.1);
    EXPECT_LE(worst[1], 0.5);
    EXPECT_LE(worst[2], 0.5);
    EXPECT_LE(worst[3], 1);
    const MeshReport measured = measure(outcome.mesh);
    EXPECT_TRUE(measured.watertight());
    EXPECT_EQ(measured.euler, 2);
    std::cout << "[ MEASURED ] box, 0.3 out: from the surface " << worst_to_surface << " cells; beyond faces "
              << worst[1] << ", edges " << worst[2] << ", corners " << worst[3] << "\n";
  }
}

TEST(Offset, OfATorusGoesInAndOut) {
  const Cloud cloud = test::torus_cloud(100'000, 3);
  for (const double d : {0.15, -0.15}) expect_offset("torus", cloud, offset_options(7, d), to_torus, 1, 0);
}

TEST(Offset, ClosesTheHoleOfATorus) {
  const MeshReport measured = measure(reconstructed(test::torus_cloud(50'000, 4), offset_options(6, 0.75)));
  EXPECT_TRUE(measured.closed());
  EXPECT_EQ(measured.components, 1);
  EXPECT_EQ(measured.euler, 2);
}

TEST(Offset, JoinsSpheresThatMeet) {
  const Cloud cloud = test::two_spheres_cloud(60'000, 5, 0.3);
  const auto distance = [](const Vec3d& p) {
    return std::min(length({p[0] + 1.15, p[1], p[2]}), length({p[0] - 1.15, p[1], p[2]})) - 1;
  };
  expect_offset("two spheres", cloud, offset_options(6, 0.05), distance, 2, 4);
  expect_offset("two spheres", cloud, offset_options(6, 0.3), distance, 1, 2);
}

TEST(Offset, IsAFieldOfDistances) {
  const Field field = Reconstructor(Device::cpu(2)).solve(test::sphere_cloud(50'000, 6), offset_options(6, 0.25), {});
  const double cell = field.cube_size_world() / 64;
  EXPECT_NEAR(field.isovalue(), -0.25 / cell, 1e-6);
  test::expect_distance_to_unit_sphere(field, 1.25, 1.5 * cell, cell);
}

TEST(Offset, DoesNotDependOnThreadsOrOrder) {
  const Cloud cloud = test::torus_cloud(8'000, 8);
  const Options options = offset_options(6, 0.1);
  const Mesh once = reconstructed(cloud, options, 1);
  expect_same_bytes(once, reconstructed(cloud, options, 3));
  expect_same_bytes(once, reconstructed(test::shuffled(cloud, 9), options));
}

TEST(Offset, TakesNoMoreMemoryThanEstimated) {
  for (const std::int64_t points : {300, 20'000}) {  // fewer than cells, and more
    const Cloud cloud = test::torus_cloud(points, 12);
    for (const double offset : {-0.1, 0.05, 0.4}) {
      const Options options = offset_options(6, offset);
      Reconstructor reconstructor(Device::cpu(2));
      (void)reconstructor.reconstruct(cloud, options);
      const std::int64_t peak = reconstructor.report().device_peak_bytes;
      EXPECT_LE(peak, estimate_device_bytes(cloud, options)) << points << " points, offset " << offset;
      EXPECT_LE(peak, estimate_device_bytes(points, options)) << points << " points, offset " << offset;
    }
  }
}

TEST(Offset, BeyondTheMiddleLeavesNothing) {
  EXPECT_EQ(error_of([] { (void)reconstructed(test::sphere_cloud(5'000, 10), offset_options(5, -1.3)); }),
            ErrorCode::empty_result);
}

TEST(Offset, RefusesWhatMakesNoSenseWithIt) {
  const Cloud cloud = test::sphere_cloud(500, 11);
  const auto refused = [&](const auto& change) {
    Options options = offset_options(4, 0.1);
    change(options);
    return error_of([&] { (void)reconstructed(cloud, options); }) == ErrorCode::usage;
  };
  EXPECT_TRUE(refused([](Options& o) { o.trim = 0.1; }));
  EXPECT_TRUE(refused([](Options& o) { o.density = true; }));
  EXPECT_TRUE(refused([](Options& o) { o.attributes = true; }));
  EXPECT_TRUE(refused([](Options& o) { o.weakness = true; }));
  EXPECT_TRUE(refused([](Options& o) { o.domain_faces = DomainFaces::open; }));
  EXPECT_TRUE(refused([](Options& o) { o.offset = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](Options& o) { o.offset = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](Options& o) {
    o.envelope = std::make_shared<const Mesh>(test::box_mesh({-2, -2, -2}, {2, 2, 2}));
  }));
}

}  // namespace
}  // namespace pointskin
