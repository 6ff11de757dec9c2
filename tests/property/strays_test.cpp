// Stray points leave no trace in the mesh: it has the bytes of the mesh without them.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"
#include "support/stray_clouds.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::NamedPlaces;
using test::reconstructed;
using test::with_points_at;

/// Compares the meshes of a cloud with and without strays, and looks at the report.
void expect_no_trace(const Cloud& clean, const std::vector<Vec3f>& strays, const Options& options) {
  Reconstructor r(Device::cpu(2));
  const Mesh expected = r.reconstruct(clean, options);
  EXPECT_EQ(r.report().strays, 0);
  EXPECT_TRUE(r.report().farthest_strays.empty());
  const Mesh mesh = r.reconstruct(with_points_at(clean, strays), options);
  expect_same_bytes(mesh, expected);
  EXPECT_EQ(r.report().points, clean.size());
  EXPECT_EQ(r.report().strays, std::ssize(strays));
  EXPECT_EQ(r.report().farthest_strays.size(), std::min<std::size_t>(10, strays.size()));
}

TEST(Strays, LeaveNoTraceInTheMesh) {
  const Cloud sphere = test::sphere_cloud(20'000, 1);
  const Cloud knot = test::linked_tori_cloud(30'000, 2, 0.5, 0.12);
  for (const NamedPlaces& strays : test::stray_places()) {
    SCOPED_TRACE(strays.name);
    expect_no_trace(sphere, strays.places, {{.depth = 7}, {.density = true}});
    expect_no_trace(knot, strays.places, {{.depth = 6}});
  }
}

TEST(Strays, AreReportedInWorldCoordinatesTheFarthestFirst) {
  Cloud cloud = test::sphere_cloud(10'000, 3);
  cloud.origin = {5e6, 4e5, 100};
  cloud = with_points_at(cloud, {{0, 0, 64}, {-4096, 0, 0}, {0, 512, 0}});
  Reconstructor r(Device::cpu(2));
  (void)r.reconstruct(cloud, {{.depth = 5}});
  EXPECT_EQ(r.report().farthest_strays,
            (std::vector<Vec3d>{{5e6 - 4096, 4e5, 100}, {5e6, 4e5 + 512, 100}, {5e6, 4e5, 164}}));
}

TEST(Strays, CountWhenTheyAreKept) {
  const Cloud cloud = with_points_at(test::sphere_cloud(10'000, 4), {{1000, 0, 0}});
  Reconstructor r(Device::cpu(2));
  const Field field = r.solve(cloud, {.depth = 5, .keep_strays = true});
  EXPECT_EQ(r.report().strays, 0);
  EXPECT_EQ(r.report().points, cloud.size());
  EXPECT_NEAR(field.cube_size_world(), 1.1 * 1001, 1);
}

TEST(Strays, DoNotDependOnOrderOrThreads) {
  const Cloud cloud = with_points_at(test::torus_cloud(20'000, 5), test::places_around(20, 6, 9, 300));
  const Mesh expected = reconstructed(cloud, {{.depth = 6}}, 1);
  expect_same_bytes(reconstructed(cloud, {{.depth = 6}}, 4), expected);
  expect_same_bytes(reconstructed(test::shuffled(cloud, 7), {{.depth = 6}}), expected);
}

TEST(Strays, AreLeftOutOfPointsOnADeviceToo) {
  const Cloud clean = test::sphere_cloud(10'000, 8);
  const Cloud cloud = with_points_at(clean, {{0, 1e6F, 0}, {-300, 2, 2}});
  Reconstructor r(Device::cpu(2));
  const UploadedCloud points = upload(r.workspace(), cloud);
  expect_same_bytes(download(r.workspace(), r.reconstruct(points, {{.depth = 6}})),
                    r.reconstruct(clean, {{.depth = 6}}));
}

TEST(Strays, AreKnownToTheEstimate) {
  const Cloud clean = test::sphere_cloud(60'000, 9);
  const Cloud cloud = with_points_at(clean, test::places_around(20, 10, 6, 200));
  for (const int depth : {4, 8}) {
    const auto expected = static_cast<double>(estimate_device_bytes(clean, {{.depth = depth}}));
    EXPECT_NEAR(static_cast<double>(estimate_device_bytes(cloud, {{.depth = depth}})), expected, 0.06 * expected);
    Reconstructor r(Device::cpu(2));
    (void)r.reconstruct(cloud, {{.depth = depth}});
    EXPECT_NEAR(static_cast<double>(estimate_device_bytes(cloud, {{.depth = depth}})),
                static_cast<double>(r.report().device_peak_bytes), 0.15 * expected);
  }
}

TEST(Strays, AloneWithNormalsEndInAnError) {
  Cloud cloud = test::sphere_cloud(1'000, 11);
  for (Vec3f& n : cloud.normals) n = {};
  cloud = with_points_at(cloud, {{500, 0, 0}});
  EXPECT_EQ(test::error_of([&] { (void)reconstructed(cloud, {{.depth = 5}}); }), ErrorCode::no_normals);
}

TEST(Strays, ArePubliclyFound) {
  const Strays found = find_strays(with_points_at(test::sphere_cloud(5'000, 12), {{90, 0, 0}, {0, 70, 0}}).positions);
  ASSERT_EQ(found.points.size(), 2U);
  EXPECT_LT(found.points[0], found.points[1]);  // spread in this order, and the first is the farther one
  EXPECT_LE(found.core.upper.x, 1);
  EXPECT_TRUE(find_strays({}).points.empty());
}

TEST(Strays, AreInNoPublicScan) {
  const std::filesystem::path folder = std::string(POINTSKIN_SOURCE_DIR) + "/../shared/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name == "corrupt_pond.ply" || entry.path().extension() == ".md") continue;
    if (entry.path().extension() != ".ply" && entry.path().extension() != ".xyz") continue;
    const Cloud cloud = read_cloud(entry.path().string());
    EXPECT_TRUE(find_strays(cloud.positions).points.empty()) << name;
    EXPECT_EQ(test::brute_strays(cloud.positions), std::vector<std::int64_t>{}) << name;
  }
}

TEST(Strays, LeaveNoTraceInAPublicScan) {
  const auto cloud = test::shared_cloud("bunny_scans");
  if (!cloud) GTEST_SKIP() << "no bunny_scans.ply in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  const Bounds box = bounds_of(cloud->positions);
  const double diameter = std::max({box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z});
  const Vec3d centre{(box.lower.x + box.upper.x) / 2, (box.lower.y + box.upper.y) / 2, (box.lower.z + box.upper.z) / 2};
  expect_no_trace(*cloud, {{1e6F, 0, 0}}, {{.depth = 8}});
  expect_no_trace(*cloud, {{0, 0, 1e30F}}, {{.depth = 8}});
  expect_no_trace(*cloud, test::places_around(20, 13, 3 * diameter, 100 * diameter, centre), {{.depth = 8}});
}

}  // namespace
}  // namespace pointskin
