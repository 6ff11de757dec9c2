// Deformed clouds: what must hold of every frame, whatever the deformation.
#include <gtest/gtest.h>

#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/crc32c.hpp"
#include "property/reconstruction.hpp"
#include "support/deformations.hpp"
#include "support/option_sets.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::moved;
using test::same_bytes;

/// A cloud whose points carry their numbers.
Cloud numbered(Cloud cloud) {
  std::vector<std::int32_t> ids(cloud.positions.size());
  std::iota(ids.begin(), ids.end(), 0);
  cloud.attributes.push_back({"id", std::move(ids)});
  return cloud;
}

double distance(const Vec3f& a, const Vec3f& b) {
  const double x = double{a.x} - double{b.x};
  const double y = double{a.y} - double{b.y};
  const double z = double{a.z} - double{b.z};
  return std::sqrt(x * x + y * y + z * z);
}

/// Mean distance to the 6 nearest of all others, by looking at all of them.
double mean_of_six(const std::vector<Vec3f>& points, std::size_t i) {
  std::vector<double> distances;
  for (std::size_t j = 0; j < points.size(); ++j)
    if (j != i) distances.push_back(distance(points[i], points[j]));
  std::partial_sort(distances.begin(), distances.begin() + 6, distances.end());
  double sum = 0;
  for (std::size_t k = 0; k < 6; ++k) sum += distances[k];
  return sum / 6;
}

/// Ratios of the spacing of samples (all, or evenly chosen ones) to that of the point that they come of, ascending.
std::vector<double> ratios_by_brute_force(const Cloud& rest, const Cloud& now) {
  constexpr std::size_t kMeasured = 1500;
  const std::size_t step = std::max<std::size_t>(1, now.positions.size() / kMeasured);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < now.positions.size(); i += step) {
    const auto from = static_cast<std::size_t>(now.attributes.back().values.as<std::int32_t>()[i]);
    ratios.push_back(mean_of_six(now.positions, i) / mean_of_six(rest.positions, from));
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

double at(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

Options shallow() {
  Options options;
  options.depth = 5;
  return options;
}

Deformer on_cpu(const Cloud& cloud, const Options& options = shallow(), int threads = 2) {
  return Deformer(cloud, options, Device::cpu(threads));
}

TEST(Identity, GivesTheBytesOfThePlainReconstruction) {
  Cloud cloud = numbered(test::torus_cloud(20000, 3));
  Options options = shallow();
  options.attributes = true;
  options.density = true;
  const Mesh expected = test::reconstructed(cloud, options);
  Deformer deformer = on_cpu(cloud, options);
  expect_same_bytes(deformer.reconstruct(), expected);
  deformer.deform(test::bend_along_x(1));
  deformer.deform({{{Ball{}, RigidMotion{}}, {Ball{}, AffineMap{}}}, {}});
  expect_same_bytes(deformer.reconstruct(), expected);
  EXPECT_EQ(deformer.report().inserted, 0);
  EXPECT_EQ(deformer.report().thinned, 0);
}

TEST(Identity, LeavesStraysOutAsThePlainReconstructionDoes) {
  Cloud cloud = test::sphere_cloud(5000, 9);
  cloud.positions.push_back({100, 3, 2});
  cloud.normals.push_back({1, 0, 0});
  const test::Outcome expected = test::run(cloud, shallow());
  ASSERT_EQ(expected.report.strays, 1);
  Deformer deformer = on_cpu(cloud);
  expect_same_bytes(deformer.reconstruct(), expected.mesh);
  EXPECT_EQ(deformer.report().run.strays, 1);
  EXPECT_EQ(deformer.report().rest_points, 5000);
  EXPECT_EQ(deformer.report().run.farthest_strays, expected.report.farthest_strays);
}

TEST(RigidMotionOfAll, MovesTheCloudExactlyToRounding) {
  const Cloud cloud = numbered(test::torus_cloud(5000, 4));
  Deformer deformer = on_cpu(cloud);
  const double angle = 1.1;
  deformer.deform(
      {{{Ball{}, RigidMotion{.axis = {0, 0, 1}, .point = {1, 0, 0}, .angle = angle, .translation = {0, 0, 3}}}}, {}});
  const Cloud now = deformer.cloud();
  ASSERT_EQ(now.size(), cloud.size());
  for (std::size_t i = 0; i < now.positions.size(); ++i) {
    const auto from = static_cast<std::size_t>(now.attributes[0].values.as<std::int32_t>()[i]);
    const auto turned = [&](const Vec3f& v, double centre) {
      const double x = double{v.x} - centre;
      return Vec3f{static_cast<float>(centre + std::cos(angle) * x - std::sin(angle) * double{v.y}),
                   static_cast<float>(std::sin(angle) * x + std::cos(angle) * double{v.y}), v.z};
    };
    const Vec3f expected = turned(cloud.positions[from], 1);
    EXPECT_NEAR(now.positions[i].x, expected.x, 3e-7);
    EXPECT_NEAR(now.positions[i].y, expected.y, 3e-7);
    EXPECT_NEAR(now.positions[i].z, expected.z + 3, 3e-7);
    const Vec3f normal = turned(cloud.normals[from], 0);
    EXPECT_NEAR(now.normals[i].x, normal.x, 1e-6);
    EXPECT_NEAR(now.normals[i].y, normal.y, 1e-6);
    EXPECT_NEAR(now.normals[i].z, normal.z, 1e-6);
  }
}

/// (x / a)^2 + (y / b)^2 + (z / c)^2 = 1, with its normals; samples that were inserted as well.
void expect_ellipsoid(const Cloud& cloud, const std::array<double, 3>& axes, double tolerance) {
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    const Vec3d g{double{p.x} / (axes[0] * axes[0]), double{p.y} / (axes[1] * axes[1]),
                  double{p.z} / (axes[2] * axes[2])};
    const double level = std::sqrt(g[0] * double{p.x} + g[1] * double{p.y} + g[2] * double{p.z});
    EXPECT_NEAR(level, 1, tolerance);
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const Vec3f& n = cloud.normals[i];
    const double cosine = (g[0] * double{n.x} + g[1] * double{n.y} + g[2] * double{n.z}) / length;
    EXPECT_GT(cosine, 1 - 10 * tolerance);
    EXPECT_NEAR(std::sqrt(double{n.x} * double{n.x} + double{n.y} * double{n.y} + double{n.z} * double{n.z}), 1, 1e-6);
  }
}

TEST(AffineScaling, OfASphereIsTheEllipsoidWithItsNormals) {
  Deformer deformer = on_cpu(test::sphere_cloud(20000, 5));
  deformer.deform({{{Ball{}, AffineMap{.matrix = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.5, 0}}}}, {}});
  EXPECT_GT(deformer.report().inserted, 0);
  EXPECT_GT(deformer.report().thinned, 0);
  expect_ellipsoid(deformer.cloud(), {2, 1, 0.5}, 3e-3);
  const MeshReport mesh = measure(deformer.reconstruct());
  EXPECT_TRUE(mesh.watertight());
  EXPECT_NEAR(mesh.volume, 4.0 / 3 * std::numbers::pi, 0.02 * 4.0 / 3 * std::numbers::pi);
}

TEST(Spacing, StaysWithinAFactorOfTwoWhereItStretchesAndSqueezes) {
  const Cloud sphere = numbered(test::sphere_cloud(2000, 6));
  for (const std::array<double, 3>& s :
       {std::array<double, 3>{3, 1, 1}, {3, 3, 3}, {1.0 / 3, 1, 1}, {1.0 / 3, 1.0 / 3, 1.0 / 3}, {3, 1.0 / 3, 1}}) {
    SCOPED_TRACE(std::to_string(s[0]) + " " + std::to_string(s[1]) + " " + std::to_string(s[2]));
    Deformer deformer = on_cpu(sphere);
    deformer.deform({{{Ball{}, AffineMap{.matrix = {s[0], 0, 0, 0, 0, s[1], 0, 0, 0, 0, s[2], 0}}}}, {}});
    const Cloud now = deformer.cloud();
    const std::vector<double> ratios = ratios_by_brute_force(sphere, now);
    EXPECT_GT(at(ratios, 0.05), 0.5);
    EXPECT_LT(at(ratios, 0.95), 2);
    EXPECT_GT(at(ratios, 0.5), 1 / 1.3);
    EXPECT_LT(at(ratios, 0.5), 1.3);
    const SpacingRatios measured = deformer.spacing();
    EXPECT_NEAR(measured.p05, at(ratios, 0.05), 0.05);
    EXPECT_NEAR(measured.median, at(ratios, 0.5), 0.05);
    EXPECT_NEAR(measured.p95, at(ratios, 0.95), 0.1);
    EXPECT_EQ(deformer.report().points, now.size());
    EXPECT_EQ(deformer.report().points, 2000 + deformer.report().inserted - deformer.report().thinned);
  }
}

TEST(Spacing, StaysOnAGridOfPoints) {
  Cloud grid;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      grid.positions.push_back({0.05F * static_cast<float>(i), 0.05F * static_cast<float>(j), 0});
      grid.normals.push_back({0, 0, 1});
    }
  grid = numbered(grid);
  for (const double s : {3.0, 1.0 / 3}) {
    Deformer deformer = on_cpu(grid);
    deformer.deform({{{Ball{}, AffineMap{.matrix = {s, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}}}, {}});
    const std::vector<double> ratios = ratios_by_brute_force(grid, deformer.cloud());
    EXPECT_GT(at(ratios, 0.05), 0.5) << s;
    EXPECT_LT(at(ratios, 0.95), 2) << s;
  }
}

TEST(Frames, DoNotDependOnHistoryThreadsOrTheOrderOfPoints) {
  const Cloud cloud = test::torus_cloud(8000, 7);
  Deformer first = on_cpu(cloud);
  first.deform(test::twist_and_pull());
  const Mesh expected = first.reconstruct();
  const Cloud cloud_expected = first.cloud();

  Deformer again = on_cpu(test::shuffled(cloud, 8), shallow(), 1);
  again.deform(test::bend_along_x(0.3));
  (void)again.reconstruct();
  again.deform(test::twist_and_pull());
  expect_same_bytes(again.reconstruct(), expected);
  expect_same_bytes(again.reconstruct(), expected);
  EXPECT_TRUE(same_bytes(again.cloud().positions, cloud_expected.positions));
  EXPECT_TRUE(same_bytes(again.cloud().normals, cloud_expected.normals));
}

TEST(Frames, AreWhatTheReconstructorMakesOfTheDeformedCloud) {
  for (auto [name, options] : test::option_sets(5, true)) {
    SCOPED_TRACE(name);
    Deformer deformer = on_cpu(numbered(test::torus_cloud(8000, 7)), options);
    deformer.deform(test::twist_and_pull());
    options.keep_strays = true;
    expect_same_bytes(deformer.reconstruct(), test::reconstructed(deformer.cloud(), options));
  }
}

TEST(Frames, DoNotDependOnTheOriginOfTheCloud) {
  const Cloud cloud = test::torus_cloud(4000, 7);
  Cloud far = cloud;
  far.origin = {1024, -2048, 512};
  Deformer here = on_cpu(cloud);
  Deformer there = on_cpu(far);
  here.deform(test::bend_along_x(0.8));
  there.deform(moved(test::bend_along_x(0.8), far.origin));
  EXPECT_TRUE(same_bytes(here.cloud().positions, there.cloud().positions));
  EXPECT_EQ(there.reconstruct().origin, far.origin);
}

TEST(PointSets, MoveWhatIsNearestToThem) {
  const Cloud cloud = numbered(test::sphere_cloud(3000, 12));
  // Single points as regions, and the balls of no radius around the same places.
  const auto ball_at = [&](std::size_t i) {
    const Vec3f& p = cloud.positions[i];
    return Ball{{double{p.x}, double{p.y}, double{p.z}}, 0};
  };
  const RigidMotion pull{.translation = {0.5, 0, 0}};
  Deformer by_points = on_cpu(cloud);
  Deformer by_balls = on_cpu(cloud);
  by_points.deform({{{PointSet{{17}}, pull}, {PointSet{{401}}}}, {}});
  by_balls.deform({{{ball_at(17), pull}, {ball_at(401)}}, {}});
  EXPECT_TRUE(same_bytes(by_points.cloud().positions, by_balls.cloud().positions));

  // Every second point held, one moved: held points stay.
  PointSet held;
  for (std::int64_t i = 0; i < cloud.size(); i += 2)
    if (i != 18) held.points.push_back(i);
  by_points.deform({{{held}, {PointSet{{18}}, pull}}, {}});
  const Cloud now = by_points.cloud();
  int found = 0;
  for (std::size_t i = 0; i < now.positions.size(); ++i) {
    const auto from = static_cast<std::size_t>(now.attributes[0].values.as<std::int32_t>()[i]);
    if (from % 2 != 0 || from == 18) continue;
    if (now.positions[i] == cloud.positions[from]) ++found;
  }
  EXPECT_GT(found, 1490);  // thinned ones aside
}

TEST(Bend, KeepsAScanClosedAndItsSamplesEven) {
  const std::optional<Cloud> bunny = test::shared_cloud("bunny_scans");
  if (!bunny) GTEST_SKIP() << "no bunny_scans";
  Options options;
  options.depth = 7;
  Deformer deformer(*bunny, options, Device::cpu());
  for (const double share : {0.5, 1.0}) {
    deformer.deform(scaled(test::bend_upright(*bunny), share));
    const MeshReport mesh = measure(deformer.reconstruct());
    EXPECT_TRUE(mesh.watertight()) << share;
    const SpacingRatios spacing = deformer.spacing();
    EXPECT_GT(spacing.p05, 0.5) << share;
    EXPECT_LT(spacing.p95, 2) << share;
  }
}

/// Every compiler and device must give these bytes. They change with a decision about the engine alone: samples that are
/// inserted are moved onto the field of the rest pose.
TEST(Bend, GivesTheBytesThatAreWrittenDownHere) {
  Deformer deformer = on_cpu(test::box_cloud(20'000, 4));
  deformer.deform(test::bend_along_x(2));
  const Cloud cloud = deformer.cloud();
  const auto bytes = [](const std::vector<Vec3f>& of) {
    return std::string_view(reinterpret_cast<const char*>(of.data()), of.size() * sizeof(Vec3f));
  };
  EXPECT_GT(deformer.report().inserted, 1000);
  EXPECT_EQ(io::crc32c(bytes(cloud.positions)), 898889027U);
  EXPECT_EQ(io::crc32c(bytes(cloud.normals)), 3294062609U);
}

TEST(Errors, HaveTheRightCodes) {
  Deformer deformer = on_cpu(test::sphere_cloud(1000, 2));
  EXPECT_EQ(test::error_of([&] { deformer.deform({{{PointSet{{1000}}}}, {}}); }), ErrorCode::usage);
  const AffineMap tiny{.matrix = {1e-4, 0, 0, 0, 0, 1e-4, 0, 0, 0, 0, 1e-4, 0}};
  EXPECT_EQ(test::error_of([&] { deformer.deform({{{Ball{}, tiny}}, {}}); }), ErrorCode::empty_result);
  EXPECT_EQ(deformer.cloud().size(), 1000);  // as before
  EXPECT_EQ(test::error_of([] { on_cpu(Cloud{}); }), ErrorCode::empty_result);
  Options options;
  options.max_memory_bytes = 1000;
  EXPECT_EQ(test::error_of([&] { on_cpu(test::sphere_cloud(1000, 2), options); }), ErrorCode::over_limit);
}

}  // namespace
}  // namespace pointskin
