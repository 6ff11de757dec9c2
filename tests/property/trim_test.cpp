// Trimming of open clouds: where the surface ends, and how smooth its border is.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::run;

/// The n samples of the unit sphere below z = `top`.
Cloud cap_cloud(std::int64_t n, std::uint64_t seed, float top) {
  const Cloud sphere = test::sphere_cloud(4 * n, seed);
  Cloud cloud;
  for (std::size_t i = 0; i < sphere.positions.size() && cloud.size() < n; ++i)
    if (sphere.positions[i].z < top) {
      cloud.positions.push_back(sphere.positions[i]);
      cloud.normals.push_back(sphere.normals[i]);
    }
  return cloud;
}

/// A tube of radius 0.7 from z = -1 to 1, leaning in y.
constexpr double kLean = 0.4;
Cloud tube_cloud(std::int64_t n, std::uint64_t seed) {
  test::Random random(seed);
  Cloud cloud;
  const auto leaning = [](double x, double y, double z) {
    return Vec3f{static_cast<float>(x), static_cast<float>(std::cos(kLean) * y - std::sin(kLean) * z),
                 static_cast<float>(std::sin(kLean) * y + std::cos(kLean) * z)};
  };
  for (std::int64_t i = 0; i < n; ++i) {
    const double a = random.in(0, 2 * std::numbers::pi);
    cloud.positions.push_back(leaning(0.7 * std::cos(a), 0.7 * std::sin(a), random.in(-1, 1)));
    cloud.normals.push_back(leaning(std::cos(a), std::sin(a), 0));
  }
  return cloud;
}

/// Vertices on the border.
std::vector<Vec3f> border_of(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax({t[k], t[(k + 1) % 3]})];
  std::vector<Vec3f> border;
  for (const auto& [edge, count] : uses)
    if (count == 1) border.push_back(mesh.vertices[static_cast<std::size_t>(edge.first)]);
  return border;
}

struct Spread {
  double mean = 0, deviation = 0;
};
Spread spread_of(const std::vector<Vec3f>& points, const std::function<double(const Vec3f&)>& f) {
  Spread s;
  for (const Vec3f& p : points) s.mean += f(p) / static_cast<double>(points.size());
  for (const Vec3f& p : points) s.deviation += std::pow(f(p) - s.mean, 2) / static_cast<double>(points.size());
  s.deviation = std::sqrt(s.deviation);
  return s;
}

struct OpenCloud {
  std::string name;
  Cloud cloud;
  double area;                                 ///< that the samples cover
  std::int64_t euler;                          ///< of the open surface
  std::function<double(const Vec3f&)> beyond;  ///< distance beyond the border of the samples
};
std::vector<OpenCloud> open_clouds(std::int64_t n) {
  return {{"cap", cap_cloud(n, 1, 0.2F), 2.4 * std::numbers::pi, 1, [](const Vec3f& p) { return p.z - 0.2; }},
          {"tube", tube_cloud(n, 2), 2.8 * std::numbers::pi, 0,
           [](const Vec3f& p) { return std::abs(std::cos(kLean) * p.z - std::sin(kLean) * p.y) - 1; }},
          {"plane", test::plane_cloud(n, 3), 4, 1,
           [](const Vec3f& p) { return static_cast<double>(std::max(std::abs(p.x), std::abs(p.y))) - 1; }}};
}

TEST(Trim, EndsTheSurfaceWithinAFewSamplesOfTheirBorderAlongASmoothLine) {
  for (const std::int64_t n : {20'000, 60'000, 150'000})
    for (const OpenCloud& open : open_clouds(n)) {
      SCOPED_TRACE(open.name + ", " + std::to_string(n) + " points");
      const Outcome r = run(open.cloud, {{.depth = 8}, {.trim = 0.05}});
      const MeshReport report = measure(r.mesh);
      EXPECT_TRUE(report.manifold());
      EXPECT_TRUE(report.oriented());
      EXPECT_FALSE(report.closed());
      EXPECT_EQ(report.used_vertices, report.vertices);
      EXPECT_EQ(report.components, 1);
      EXPECT_EQ(report.euler, open.euler) << "holes";
      const double spacing = std::sqrt(open.area / static_cast<double>(n));
      const Spread border = spread_of(border_of(r.mesh), open.beyond);
      EXPECT_GT(border.mean, 0.5 * spacing);
      EXPECT_LT(border.mean, 4.5 * spacing);
      EXPECT_LT(border.deviation, 1.2 * spacing);
      EXPECT_NEAR(report.area, open.area, 6 * spacing * 9);  // borders are at most 9 long
    }
}

TEST(Trim, ReportsWhatItRemoved) {
  const Cloud cloud = cap_cloud(40'000, 4, 0);
  const Outcome whole = run(cloud, {{.depth = 7}});
  const Outcome trimmed = run(cloud, {{.depth = 7}, {.trim = 0.02}});
  EXPECT_EQ(whole.report.trim.triangles_before, 0);
  const TrimReport& t = trimmed.report.trim;
  EXPECT_EQ(t.triangles_before, static_cast<std::int64_t>(whole.mesh.triangles.size()));
  EXPECT_NEAR(t.area_before, measure(whole.mesh).area, 1e-4 * t.area_before);
  EXPECT_NEAR(t.area_before - t.area_removed, measure(trimmed.mesh).area, 1e-4 * t.area_before);
  EXPECT_GT(t.triangles_removed, 0);
  EXPECT_EQ(t.triangles_split, measure(trimmed.mesh).boundary_edges);
  EXPECT_LT(static_cast<std::int64_t>(trimmed.mesh.triangles.size()), t.triangles_before);
  const double density = 40'000 / (2 * std::numbers::pi);
  EXPECT_GT(t.density, density / 8);
  EXPECT_LT(t.density, density / 2);
}

TEST(Trim, LeavesAClosedEvenCloudAsItIs) {
  for (const Cloud& cloud : {test::sphere_cloud(30'000, 5), test::torus_cloud(100'000, 6), test::box_cloud(50'000, 7)})
    for (const double trim : {0.001, 0.01, 0.05})
      expect_same_bytes(run(cloud, {{.depth = 7}, {.trim = trim}}).mesh, run(cloud, {{.depth = 7}}).mesh);
}

TEST(Trim, KeepsTheSparserHalfOfMixedSamplesUnlessAskedToCutIt) {
  test::Random random(8);
  const Cloud cap = cap_cloud(100'000, 9, 0.2F);
  Cloud cloud;  // ten times sparser where x < 0: an eleventh of the points
  for (std::size_t i = 0; i < cap.positions.size(); ++i)
    if (cap.positions[i].x > 0 || random.unit() < 0.1) {
      cloud.positions.push_back(cap.positions[i]);
      cloud.normals.push_back(cap.normals[i]);
    }
  const double area = 2.4 * std::numbers::pi;
  const MeshReport both = measure(run(cloud, {{.depth = 8}, {.trim = 0.02}}).mesh);
  EXPECT_EQ(both.euler, 1);
  EXPECT_NEAR(both.area, area, 0.12 * area);  // a few of the sparser spacings of 0.03 beyond a border of 6.2
  const MeshReport dense = measure(run(cloud, {{.depth = 8}, {.trim = 0.3}}).mesh);
  EXPECT_NEAR(dense.area, area / 2, 0.08 * area);
}

TEST(Trim, RemovesIslandsUnlessTheRatioIsZero) {
  Cloud cloud = cap_cloud(60'000, 10, 0.2F);
  for (int k = 0; k < 4; ++k)
    test::append(cloud, test::sphere_cloud(150, 11 + static_cast<std::uint64_t>(k), 0.02,
                                           {std::cos(1.5 * k), std::sin(1.5 * k), 0.9}));
  const Outcome cleared = run(cloud, {{.depth = 8}, {.trim = 0.02, .island_ratio = 0.01}});
  EXPECT_EQ(measure(cleared.mesh).components, 1);
  EXPECT_GE(cleared.report.trim.islands_removed, 4);
  const Outcome all = run(cloud, {{.depth = 8}, {.trim = 0.02, .island_ratio = 0}});
  EXPECT_GE(measure(all.mesh).components, 5);
  EXPECT_EQ(all.report.trim.islands_removed + all.report.trim.holes_filled, 0);
}

/// Half of the points in a spot of a 1600th of the sphere.
Cloud spotted_sphere() {
  Cloud cloud = test::sphere_cloud(20'000, 15);
  const Cloud fine = test::sphere_cloud(400'000, 16);
  for (std::size_t i = 0; i < fine.positions.size(); ++i)
    if (fine.positions[i].z > 1 - 2.0F / 1600)
      for (int copy = 0; copy < 80; ++copy) {
        cloud.positions.push_back(fine.positions[i]);
        cloud.normals.push_back(fine.normals[i]);
      }
  return cloud;
}

TEST(Trim, EndsInAnErrorWhereNothingIsLeft) {
  const Cloud cloud = spotted_sphere();
  EXPECT_EQ(error_of([&] {
              (void)run(cloud, {{.depth = 7}, {.trim = 0.8, .island_ratio = 0.05}});
            }),
            ErrorCode::empty_result);
  EXPECT_EQ(error_of([&] { (void)run(cloud, {{.depth = 7}, {.trim = 0.8, .island_ratio = 0}}); }), std::nullopt);
}

TEST(Trim, GivesTheSameBytesForAnyThreadsAndOrderOfThePoints) {
  const Cloud cloud = test::jittered(cap_cloud(30'000, 17, 0.1F), 18, 0.005);
  const Options options{{.depth = 7}, {.trim = 0.1, .density = true}};
  const Mesh expected = run(cloud, options, 1).mesh;
  for (const int threads : {2, 16}) expect_same_bytes(run(cloud, options, threads).mesh, expected);
  for (const std::uint64_t seed : {1, 2}) expect_same_bytes(run(test::shuffled(cloud, seed), options).mesh, expected);
  ASSERT_EQ(expected.attributes.size(), 1U);
  EXPECT_EQ(expected.attributes[0].values.size(), expected.vertices.size());
}

TEST(Trim, OfAFieldAndWithoutNormalsIsTheSame) {
  const Cloud cloud = cap_cloud(20'000, 19, 0.1F);
  const Mesh expected = run(cloud, {{.depth = 7}, {.trim = 0.05}}).mesh;
  EXPECT_EQ(expected.normals.size(), expected.vertices.size());
  Reconstructor r(Device::cpu(2));
  const Field field = r.solve(cloud, {.depth = 7});
  expect_same_bytes(field.extract({.trim = 0.05}), expected);
  expect_same_bytes(field.extract({.trim = 0.05}), expected);
  expect_same_bytes(field.extract(), test::reconstructed(cloud, {{.depth = 7}}));
  const Mesh bare = run(cloud, {{.depth = 7}, {.normals = false, .trim = 0.05}}).mesh;
  EXPECT_TRUE(bare.normals.empty());
  EXPECT_EQ(bare.vertices, expected.vertices);
  EXPECT_EQ(bare.triangles, expected.triangles);
}

TEST(Trim, WorksWithOpenFacesOfTheDomain) {
  const MeshReport report = measure(
      run(test::plane_cloud(30'000, 20), {{.depth = 7}, {.domain_faces = DomainFaces::open, .trim = 0.05}}).mesh);
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented());
  EXPECT_NEAR(report.area, 4, 0.3);
}

TEST(Trim, OfScansLeavesAManifoldWithABorder) {
  for (const char* name : {"lion_takanawa_npm", "cgal_building"}) {
    const auto cloud = test::shared_cloud(name);
    if (!cloud) GTEST_SKIP() << "no " << name << " in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
    SCOPED_TRACE(name);
    const Outcome r = run(*cloud, {{.depth = 8}, {.trim = 0.05}});
    const MeshReport report = measure(r.mesh);
    EXPECT_TRUE(report.manifold());
    EXPECT_TRUE(report.oriented());
    EXPECT_FALSE(report.closed());
    EXPECT_GT(r.report.trim.area_removed, 0.1 * r.report.trim.area_before);
    EXPECT_LT(r.report.trim.area_removed, 0.9 * r.report.trim.area_before);
  }
}

TEST(Trim, OfTinyCloudsEndsInAManifoldOrAnEmptyResult) {
  int meshes = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    test::Random random(seed);
    Cloud cloud;
    for (std::int64_t i = 1 + random.below(60); i > 0; --i) {
      const Vec3d p = random.direction();
      const Vec3d n = random.direction();
      cloud.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
      cloud.normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
    const Options options{{.depth = 1 + static_cast<int>(random.below(9)), .scale = seed % 5 == 0 ? 1.0 : 1.1},
                          {.domain_faces = seed % 3 == 0 ? DomainFaces::open : DomainFaces::closed,
                           .trim = random.in(0.001, 0.999),
                           .island_ratio = seed % 2 == 0 ? 0 : random.in(0, 0.5)}};
    SCOPED_TRACE("seed " + std::to_string(seed) + ", depth " + std::to_string(options.depth));
    const auto code = error_of([&] {
      const MeshReport report = measure(run(cloud, options, 1).mesh);
      EXPECT_TRUE(report.manifold());
      EXPECT_TRUE(report.oriented());
      EXPECT_EQ(report.used_vertices, report.vertices);
      EXPECT_GT(report.triangles, 0);
    });
    EXPECT_EQ(code.value_or(ErrorCode::empty_result), ErrorCode::empty_result);
    meshes += code ? 0 : 1;
  }
  EXPECT_GT(meshes, 75);
}

TEST(Trim, IsCheckedToBeAShareBelowOne) {
  for (const double bad : {-0.1, 1.0, 7.0, std::nan("")}) {
    EXPECT_EQ(error_of([&] { validate(Options{{}, {.trim = bad}}); }), ErrorCode::usage) << bad;
    EXPECT_EQ(error_of([&] { validate(Options{{}, {.island_ratio = bad}}); }), ErrorCode::usage) << bad;
  }
  EXPECT_NO_THROW(validate(Options{{}, {.trim = 0.999, .island_ratio = 0.999}}));
}

}  // namespace
}  // namespace pointskin
