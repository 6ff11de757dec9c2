// Clouds that are hard: repeated points, no area, unlike densities, flipped normals, odd units. A good mesh, or the
// promised error, in little time and memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::reconstructed;
using test::scaled;

void expect_closed(const Mesh& mesh) {
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.closed());
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented());
}

/// A closed mesh or the error "empty result"; no crash, no hang, no more than `limit_bytes`.
void expect_defined(const Cloud& cloud, const Options& options, std::int64_t limit_bytes = 2'000'000'000) {
  Reconstructor r(Device::cpu(2));
  const auto code = error_of([&] {
    expect_closed(r.reconstruct(cloud, options));
    EXPECT_LT(r.report().device_peak_bytes, limit_bytes);
  });
  EXPECT_EQ(code.value_or(ErrorCode::empty_result), ErrorCode::empty_result);
}

/// Root of the mean squared distance of the vertices for which `counts` holds from the unit sphere.
template <class Counts>
double rms_off_sphere(const Mesh& mesh, const Counts& counts) {
  double sum = 0;
  std::int64_t n = 0;
  for (const Vec3f& v : mesh.vertices) {
    if (!counts(v)) continue;
    sum += std::pow(std::hypot(v.x, v.y, v.z) - 1.0, 2);
    ++n;
  }
  EXPECT_GT(n, 0);
  return std::sqrt(sum / static_cast<double>(std::max<std::int64_t>(n, 1)));
}

// ---- Repeated points

TEST(RepeatedPoints, AllTwiceKeepTheSurface) {
  const Cloud once = test::sphere_cloud(20'000, 1);
  Cloud twice = once;
  test::append(twice, once);
  const Mesh mesh = reconstructed(twice, {{.depth = 6}});
  expect_closed(mesh);
  EXPECT_EQ(measure(mesh).euler, 2);
  const auto everywhere = [](const Vec3f&) { return true; };
  EXPECT_LT(rms_off_sphere(mesh, everywhere),
            1.2 * rms_off_sphere(reconstructed(once, {{.depth = 6}}), everywhere) + 1e-4);
}

TEST(RepeatedPoints, ByTheThousandAtOnePlaceKeepTheSurface) {
  const Cloud once = test::sphere_cloud(20'000, 2);
  Cloud cloud = once;
  for (int i = 0; i < 50'000; ++i) {
    cloud.positions.push_back(once.positions[7]);
    cloud.normals.push_back(once.normals[7]);
  }
  for (const int depth : {6, 8, 10}) {
    const Mesh mesh = reconstructed(cloud, {{.depth = depth}});
    SCOPED_TRACE("depth " + std::to_string(depth));
    EXPECT_TRUE(measure(mesh).watertight());
    EXPECT_LT(rms_off_sphere(mesh, [](const Vec3f&) { return true; }), 0.01);
  }
}

// ---- No area

Cloud line(std::int64_t n, Vec3d direction) {
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n);
    cloud.positions.push_back({static_cast<float>(t * direction[0]), static_cast<float>(t * direction[1]),
                               static_cast<float>(t * direction[2])});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

TEST(NoArea, EndsInAClosedMeshOrIsEmpty) {
  for (const int depth : {1, 4, 7, 9}) {
    SCOPED_TRACE("depth " + std::to_string(depth));
    expect_defined(line(10'000, {1, 0, 0}), {{.depth = depth}});
    expect_defined(line(10'000, {1, 2, -3}), {{.depth = depth}});
    expect_defined(line(2, {1, 1, 1}), {{.depth = depth}});
    expect_defined(line(3, {0, 0, 1}), {{.depth = depth}});
    expect_defined(test::plane_cloud(20'000, 3), {{.depth = depth}});
  }
  Cloud two_sided = test::plane_cloud(20'000, 4);  // thickness zero
  test::append(two_sided, test::flipped(two_sided));
  for (const int depth : {4, 8}) expect_defined(two_sided, {{.depth = depth}});
}

TEST(NoArea, FewPointsAtDepthTwelveTakeLittleMemory) {
  for (const std::int64_t n : {1, 2, 3, 10, 100})
    for (const int depth : {10, 12}) {
      SCOPED_TRACE(std::to_string(n) + " points, depth " + std::to_string(depth));
      expect_defined(test::sphere_cloud(n, 5), {{.depth = depth}}, 400'000'000);
    }
  expect_defined(line(100, {1, 0, 0}), {{.depth = 12}}, 400'000'000);
}

// ---- Unlike densities

/// A unit sphere of which the half z < 0 has `ratio` times fewer points an area.
Cloud uneven_sphere(std::int64_t n, std::int64_t ratio) {
  const Cloud dense = test::sphere_cloud(n, 6);
  const Cloud sparse = test::sphere_cloud(n / ratio, 7);
  Cloud cloud;
  for (const Cloud* half : {&dense, &sparse})
    for (std::size_t i = 0; i < half->positions.size(); ++i) {
      if ((half->positions[i].z > 0) != (half == &dense)) continue;
      cloud.positions.push_back(half->positions[i]);
      cloud.normals.push_back(half->normals[i]);
    }
  return cloud;
}

TEST(UnlikeDensities, FollowBothAndLoseNothingWhereItIsDense) {
  struct Case {
    std::int64_t n, ratio;
  };
  for (const auto [n, ratio] : {Case{200'000, 100}, Case{2'000'000, 1000}}) {  // 1000 points on the sparse half
    SCOPED_TRACE("1 : " + std::to_string(ratio));
    const auto deep_in_dense = [](const Vec3f& v) { return v.z > 0.2F; };
    const double reference = rms_off_sphere(reconstructed(test::sphere_cloud(n, 6), {{.depth = 6}}), deep_in_dense);
    const Mesh mesh = reconstructed(uneven_sphere(n, ratio), {{.depth = 6}});
    const MeshReport report = measure(mesh);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.euler, 2);
    const double dense = rms_off_sphere(mesh, deep_in_dense);
    const double sparse = rms_off_sphere(mesh, [](const Vec3f& v) { return v.z < -0.2F; });
    RecordProperty("rms_even_" + std::to_string(ratio), std::to_string(reference));
    RecordProperty("rms_dense_" + std::to_string(ratio), std::to_string(dense));
    RecordProperty("rms_sparse_" + std::to_string(ratio), std::to_string(sparse));
    EXPECT_LT(dense, 1.25 * reference + 1e-5);
    EXPECT_LT(sparse, 0.08 / 10);  // the points of the sparse half are 0.08 apart
  }
}

// ---- Flipped normals

Cloud with_flipped_normals(Cloud cloud, double share, std::uint64_t seed) {
  test::Random random(seed);
  for (Vec3f& n : cloud.normals)
    if (random.unit() < share) n = {-n.x, -n.y, -n.z};
  return cloud;
}

TEST(FlippedNormals, OfATenthOfThePointsKeepTheSurface) {
  const Cloud cloud = test::sphere_cloud(50'000, 8);
  for (const double share : {0.05, 0.1, 0.2}) {
    SCOPED_TRACE(share);
    const Mesh mesh = reconstructed(with_flipped_normals(cloud, share, 9), {{.depth = 7}});
    EXPECT_TRUE(measure(mesh).watertight());
    EXPECT_LT(rms_off_sphere(mesh, [](const Vec3f&) { return true; }), 0.01);
  }
}

TEST(FlippedNormals, OfABuildingKeepItsWalls) {
  const auto cloud = test::shared_cloud("cgal_building");
  if (!cloud) GTEST_SKIP() << "no cgal_building.ply in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  if (!cloud->has_normals()) GTEST_SKIP() << "cgal_building.ply has no normals";
  const Options given{{.depth = 8, .point_normals = PointNormals::given}};
  const Mesh clean = reconstructed(*cloud, given);
  const double off_clean = compare(*cloud, clean, {.samples = 100'000}).to_reference.rms;
  for (const double share : {0.05, 0.1, 0.2}) {
    SCOPED_TRACE(share);
    const Cloud flipped = with_flipped_normals(*cloud, share, 10);
    const Mesh mesh = reconstructed(flipped, given);
    expect_closed(mesh);
    const MeshComparison comparison = compare(mesh, clean, {.samples = 100'000});
    const double rms = comparison.two_sided.rms / comparison.reference_diagonal;
    RecordProperty("rms_percent_" + std::to_string(share), std::to_string(100 * rms));
    EXPECT_LT(rms, 0.01);

    // Repaired normals close the building in another way where nothing was scanned; the walls are where the points are.
    const test::Outcome repaired = test::run(flipped, {{.depth = 8}});
    expect_closed(repaired.mesh);
    EXPECT_EQ(repaired.report.normals_done, NormalsDone::repaired);
    const double off = compare(*cloud, repaired.mesh, {.samples = 100'000}).to_reference.rms;
    RecordProperty("points_off_" + std::to_string(share), std::to_string(off / off_clean));
    EXPECT_LT(off, off_clean);  // as near as with the normals that the file came with
  }
}

// ---- Units

TEST(Units, ThatArePowersOfTwoGiveTheSameTriangles) {
  const Cloud cloud = test::torus_cloud(10'000, 11);
  const Mesh expected = reconstructed(cloud, {{.depth = 6}});
  for (const int exponent : {-100, -40, -20, -3, 3, 20, 40, 100}) {  // 1e-30 to 1e30
    const auto factor = static_cast<float>(std::ldexp(1.0, exponent));
    const Mesh mesh = reconstructed(scaled(cloud, factor), {{.depth = 6}});
    SCOPED_TRACE("2^" + std::to_string(exponent));
    EXPECT_TRUE(test::same_bytes(mesh.triangles, expected.triangles));
    EXPECT_TRUE(test::same_bytes(mesh.normals, expected.normals));
    ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      ASSERT_EQ(mesh.vertices[i].x, expected.vertices[i].x * factor);
  }
}

TEST(Units, FromPicometresToTerametresGiveTheSameShape) {
  const Cloud cloud = test::torus_cloud(10'000, 12);
  const MeshReport expected = measure(reconstructed(cloud, {{.depth = 6}}));
  for (const float factor : {1e-12F, 1e-9F, 1e-6F, 1e-3F, 1e3F, 1e6F, 1e9F, 1e12F}) {
    SCOPED_TRACE(factor);
    const MeshReport report = measure(reconstructed(scaled(cloud, factor), {{.depth = 6}, {.density = true}}));
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.euler, expected.euler);
    EXPECT_NEAR(static_cast<double>(report.triangles), static_cast<double>(expected.triangles),
                0.001 * static_cast<double>(expected.triangles));
  }
}

// ---- Not finite

TEST(NotFinite, CoordinatesOrNormalsAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    Cloud cloud = test::sphere_cloud(1'000, 13);
    cloud.positions[500].y = bad;
    EXPECT_EQ(error_of([&] { (void)reconstructed(cloud, {{.depth = 5}}); }), ErrorCode::invalid_input);
    cloud = test::sphere_cloud(1'000, 13);
    cloud.normals[999].z = bad;
    EXPECT_EQ(error_of([&] { (void)reconstructed(cloud, {{.depth = 5}}); }), ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace pointskin
