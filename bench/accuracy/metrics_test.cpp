// Meshes whose distance from the truth is known.
#include "metrics.hpp"

#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

/// An octahedron, each face halved `levels` times, its corners at `radius`.
Mesh sphere_mesh(double radius, int levels, const Vec3d& origin = {0, 0, 0}) {
  Mesh mesh;
  mesh.origin = origin;
  std::vector<Vec3d> corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(corners.size()));
      if (fresh)
        corners.push_back(normalized(corners[static_cast<std::size_t>(a)] + corners[static_cast<std::size_t>(b)]));
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (const Vec3d& c : corners)
    mesh.vertices.push_back({static_cast<float>(radius * c[0] - origin[0]),
                             static_cast<float>(radius * c[1] - origin[1]),
                             static_cast<float>(radius * c[2] - origin[2])});
  return mesh;
}

Mesh box_mesh(const Vec3d& half) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back({static_cast<float>((corner & 1) != 0 ? half[0] : -half[0]),
                             static_cast<float>((corner & 2) != 0 ? half[1] : -half[1]),
                             static_cast<float>((corner & 4) != 0 ? half[2] : -half[2])});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

constexpr std::int64_t kSamples = 50'000;

TEST(Metrics, MeasureASphereThatIsTooLarge) {
  const auto shape = make_shape("sphere");
  // The faces cut the sphere of radius 1.01 by at most edge^2 / 8 * 4/3 < 0.0005.
  const Metrics m = measure_against(sphere_mesh(1.01, 6), "sphere", *shape, {.samples = kSamples, .tau = 0.001});
  for (const DistanceStatistics& d : {m.comparison.to_reference, m.comparison.from_reference, m.comparison.two_sided}) {
    EXPECT_NEAR(d.mean, 0.01, 0.0005);
    EXPECT_NEAR(d.rms, 0.01, 0.0005);
    EXPECT_NEAR(d.p95, 0.01, 0.0005);
    EXPECT_NEAR(d.max, 0.01, 0.0005);
  }
  EXPECT_NEAR(m.comparison.reference_diagonal, 2 * std::sqrt(3.0), 1e-3);
  EXPECT_GT(m.comparison.normal_consistency, 0.999);
  EXPECT_EQ(m.comparison.f_score, 0);  // 0.01 is more than 0.001 of the diagonal
  EXPECT_EQ(m.mesh.components, 1);
  EXPECT_EQ(m.mesh.euler, 2);
}

TEST(Metrics, FindNothingWrongWithTheSlabItself) {
  const auto shape = make_shape("slab");
  const Metrics m = measure_against(box_mesh({0.9, 0.6, 0.02}), "slab", *shape, {.samples = kSamples, .tau = 0.001});
  EXPECT_LT(m.comparison.two_sided.max, 1e-7);  // float's rounding of the corners
  EXPECT_NEAR(m.comparison.normal_consistency, 1, 1e-12);
  EXPECT_EQ(m.comparison.f_score, 1);
  EXPECT_TRUE(m.mesh.watertight());
}

TEST(Metrics, SeeWhatIsMissingAndWhatIsTooMuch) {
  const auto shape = make_shape("nested");
  const Metrics outer_only =
      measure_against(sphere_mesh(0.95, 6), "nested", *shape, {.samples = kSamples, .tau = 0.001});
  EXPECT_LT(outer_only.comparison.to_reference.max, 0.0005);
  EXPECT_NEAR(outer_only.comparison.from_reference.max, 0.65, 0.001);  // of the innermost sphere
  const double area = 0.09 + 0.36 + 0.9025;
  EXPECT_NEAR(outer_only.comparison.recall, 0.9025 / area, 0.01);
  EXPECT_EQ(outer_only.comparison.precision, 1);
}

TEST(Metrics, AgreeWithThoseOfAFineMeshOfTheShape) {
  const auto shape = make_shape("sphere");
  const CompareOptions options{.samples = kSamples, .tau = 0.01};
  const Mesh mesh = sphere_mesh(1.02, 3);  // coarse: chords matter
  const MeshComparison a = measure_against(mesh, "sphere", *shape, options).comparison;
  const MeshComparison b = measure_against(mesh, "mesh", sphere_mesh(1, 8), options).comparison;
  EXPECT_NEAR(a.two_sided.mean, b.two_sided.mean, 1e-4);
  EXPECT_NEAR(a.two_sided.rms, b.two_sided.rms, 1e-4);
  EXPECT_NEAR(a.two_sided.max, b.two_sided.max, 3e-4);
  EXPECT_NEAR(a.normal_consistency, b.normal_consistency, 1e-3);
}

TEST(Metrics, DoNotDependOnThreadsOrTheOriginOfTheMesh) {
  const auto shape = make_shape("gyroid");
  const CompareOptions one{.samples = 1'000, .tau = 0.01, .threads = 1},
      three{.samples = 1'000, .tau = 0.01, .threads = 3};
  const Mesh mesh = sphere_mesh(1, 3);
  const auto text = [&](const Mesh& of, const CompareOptions& options) {
    return to_json(measure_against(of, "gyroid", *shape, options), options, 100).dump();
  };
  EXPECT_EQ(text(mesh, one), text(mesh, three));
  const auto torus = make_shape("torus");
  const MeshComparison here = measure_against(mesh, "torus", *torus, one).comparison;
  const MeshComparison there = measure_against(sphere_mesh(1, 3, {8, -4, 2}), "torus", *torus, one).comparison;
  EXPECT_NEAR(here.two_sided.mean, there.two_sided.mean, 1e-6);
}

TEST(Metrics, AreJsonInThreeUnits) {
  const auto shape = make_shape("sphere");
  const CompareOptions options{.samples = 5'000, .tau = 0.001};
  const auto json = to_json(measure_against(sphere_mesh(1.01, 5), "sphere", *shape, options), options, 10'000);
  const double mean = json["two_sided"]["mean"];
  EXPECT_DOUBLE_EQ(json["two_sided"]["percent"]["mean"], 100 * mean / json["truth"]["diagonal"].get<double>());
  EXPECT_DOUBLE_EQ(json["two_sided"]["spacings"]["mean"], mean / json["spacing"].get<double>());
  EXPECT_NEAR(json["spacing"].get<double>(), std::sqrt(4 * std::acos(-1.0) / 10'000), 1e-4);
  EXPECT_EQ(json["result"]["genus"], 0);
  EXPECT_EQ(json["truth"]["genus"], 0);
}

TEST(Metrics, GiveNoGenusToAnOpenMesh) {
  Mesh open = sphere_mesh(1, 3);
  open.triangles.pop_back();
  const auto shape = make_shape("sphere");
  const CompareOptions options{.samples = 1'000};
  const auto json = to_json(measure_against(open, "sphere", *shape, options), options, 0);
  EXPECT_TRUE(json["result"]["genus"].is_null());
  EXPECT_TRUE(json["spacing"].is_null());
  EXPECT_FALSE(json["two_sided"].contains("spacings"));
}

TEST(Metrics, RefuseAMeshWithoutTrianglesAndOptionsOutOfRange) {
  const auto shape = make_shape("sphere");
  EXPECT_THROW(measure_against(Mesh{}, "sphere", *shape, {}), Error);
  EXPECT_THROW(measure_against(sphere_mesh(1, 0), "sphere", *shape, {.samples = 0}), Error);
  EXPECT_THROW(measure_against(sphere_mesh(1, 0), "sphere", *shape, {.tau = 0}), Error);
}

}  // namespace
}  // namespace pointskin::bench
