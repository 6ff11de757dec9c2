#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu.hpp"
#include "mesh/surface_samples.hpp"
#include "mesh/triangle_tree.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::box_mesh;
using test::icosphere_mesh;
using test::patch_mesh;
using test::Random;

CompareOptions with(std::int64_t samples, int threads = 0) { return {samples, 0.01, threads}; }

ErrorCode code_of(const Mesh& mesh, const Mesh& reference, const CompareOptions& options = {}) {
  try {
    compare(mesh, reference, options);
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode{0};
}

/// Triangles of very different sizes and shapes, some of them needles, segments and points.
Mesh random_triangles(int n, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (int i = 0; i < n; ++i) {
    const double size = std::pow(10, random.in(-3, 0));
    const Vec3d centre{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back({static_cast<float>(centre[0] + size * random.in(-1, 1)),
                               static_cast<float>(centre[1] + size * random.in(-1, 1)),
                               static_cast<float>(centre[2] + size * random.in(-1, 1))});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    if (i % 10 == 1) mesh.vertices[static_cast<std::size_t>(3 * i)] = mesh.vertices.back();
    if (i % 10 == 2) mesh.triangles.back() = {3 * i, 3 * i, 3 * i};
  }
  return mesh;
}

TEST(PointTriangleDistance, IsRightInEveryRegion) {
  const EdgedTriangle t{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 2}, t), 4);                    // over the face
  EXPECT_DOUBLE_EQ(squared_distance({-1, -2, 2}, t), 1 + 4 + 4);          // corner a
  EXPECT_DOUBLE_EQ(squared_distance({6, -1, 0}, t), 4 + 1);               // corner b
  EXPECT_DOUBLE_EQ(squared_distance({-1, 5, 0}, t), 1 + 4);               // corner c
  EXPECT_DOUBLE_EQ(squared_distance({2, -3, 4}, t), 9 + 16);              // edge ab
  EXPECT_DOUBLE_EQ(squared_distance({-2, 1, 0}, t), 4);                   // edge ac
  EXPECT_DOUBLE_EQ(squared_distance({2 + 3, 1.5 + 4, 12}, t), 25 + 144);  // edge bc, along its normal (3, 4) / 5
}

TEST(PointTriangleDistance, FallsBackToEdgesWhereThereIsNoPlane) {
  const Vec3d p{1, 2, 0};
  EXPECT_DOUBLE_EQ(squared_distance(p, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), 5);     // a point
  EXPECT_DOUBLE_EQ(squared_distance(p, {{0, 0, 0}, {0, 0, 0}, {3, 0, 0}}), 4);     // a = b
  EXPECT_DOUBLE_EQ(squared_distance(p, {{0, 0, 0}, {3, 0, 0}, {0, 0, 0}}), 4);     // a = c
  EXPECT_DOUBLE_EQ(squared_distance(p, {{0, 0, 0}, {3, 0, 0}, {3, 0, 0}}), 4);     // b = c
  EXPECT_DOUBLE_EQ(squared_distance(p, {{0, 0, 0}, {-1, 0, 0}, {3, 0, 0}}), 4);    // a between b and c
  EXPECT_DOUBLE_EQ(squared_distance(p, {{-1, 0, 0}, {0.5, 0, 0}, {9, 0, 0}}), 4);  // b between a and c
}

TEST(PointTriangleDistance, AgreesWithADenseSearchOverTheTriangle) {
  Random random(7);
  constexpr int kSteps = 300;
  for (int trial = 0; trial < 50; ++trial) {
    const auto vector = [&] { return Vec3d{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}; };
    const EdgedTriangle t{vector(), vector(), vector()};
    const Vec3d p = vector();
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3d q = t.a + (i / double{kSteps} * t.ab + j / double{kSteps} * t.ac);
        best = std::min(best, length(p - q));
      }
    const double exact = std::sqrt(squared_distance(p, t));
    EXPECT_LE(exact, best + 1e-12) << "seed 7, trial " << trial;
    EXPECT_NEAR(exact, best, 4.0 / kSteps) << "seed 7, trial " << trial;  // edges are no longer than 2 sqrt(3)
  }
}

TEST(TriangleTree, AgreesWithBruteForceOnRandomTriangles) {
  exec::Cpu ex(2);
  for (const int n : {1, 3, 4, 5, 9, 700}) {
    const std::uint64_t seed = 100 + static_cast<std::uint64_t>(n);
    const Mesh mesh = random_triangles(n, seed);
    const Vec3d offset{0.25, -3, 0.5};
    const mesh_detail::TriangleTree tree(ex, mesh, offset);
    Random random(seed + 1);
    for (int query = 0; query < 300; ++query) {
      const Vec3d p{random.in(-2, 2), random.in(-5, -1), random.in(-2, 2)};
      double best = std::numeric_limits<double>::infinity();
      for (int t = 0; t < n; ++t)
        best = std::min(best, squared_distance(p, mesh_detail::edged_triangle(mesh, offset, t)));
      const mesh_detail::Nearest found = tree.nearest(p);
      ASSERT_NEAR(found.squared_distance, best, 1e-13) << "n " << n << ", seed " << seed << ", query " << query;
      const auto hint = static_cast<std::int32_t>(random.below(n));
      ASSERT_EQ(tree.id(tree.nearest(p, hint).slot), tree.id(found.slot)) << "seed " << seed << ", query " << query;
    }
  }
}

TEST(TriangleTree, HoldsEveryTriangleOnce) {
  exec::Cpu ex(2);
  for (const int n : {1, 2, 4, 5, 255, 256, 257, 1000}) {
    const mesh_detail::TriangleTree tree(ex, random_triangles(n, 5), {0, 0, 0});
    std::vector<std::int32_t> ids;
    for (std::int32_t slot = 0; slot < n; ++slot) ids.push_back(tree.id(slot));
    std::sort(ids.begin(), ids.end());
    for (std::int32_t i = 0; i < n; ++i) ASSERT_EQ(ids[static_cast<std::size_t>(i)], i) << n;
  }
}

TEST(SurfaceSampler, GivesEachTriangleItsShareByArea) {
  // Areas 1/2 and 9/2: of 10000 strata exactly 1000 lie in the first triangle, but for the one across the border.
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {10, 0, 0}, {13, 0, 0}, {10, 3, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 4, 5}, {5, 5, 5}};
  exec::Cpu ex(1);
  const mesh_detail::SurfaceSampler sampler(ex, mesh, {0, 0, 0});
  int small = 0;
  Vec3d sum{0, 0, 0};
  for (int i = 0; i < 10000; ++i) {
    const mesh_detail::SurfaceSample sample = sampler.sample(i, 10000);
    ASSERT_EQ(sample.normal, (Vec3d{0, 0, 1}));
    if (sample.point[0] <= 1) ++small;
    if (sample.point[0] >= 10) sum += sample.point;
  }
  EXPECT_NEAR(small, 1000, 1);
  // Uniform on the triangle: the mean is its centroid (11, 1, 0), to about size / samples for a quasirandom sequence.
  EXPECT_NEAR(sum[0] / (10000 - small), 11, 0.01);
  EXPECT_NEAR(sum[1] / (10000 - small), 1, 0.01);
}

TEST(Compare, FindsNoDistanceFromAMeshToItself) {
  const Mesh mesh = test::torus_mesh(60, 30);
  const MeshComparison result = compare(mesh, mesh, with(20'000));
  EXPECT_LT(result.two_sided.max, 1e-15);
  EXPECT_EQ(result.precision, 1);
  EXPECT_EQ(result.recall, 1);
  EXPECT_EQ(result.f_score, 1);
  EXPECT_NEAR(result.normal_consistency, 1, 1e-12);
}

TEST(Compare, GivesExactlyTheOffsetOfATranslatedPatch) {
  const MeshComparison result = compare(patch_mesh(8, 1, 0.25), patch_mesh(5), with(5'000));
  for (const DistanceStatistics& s : {result.to_reference, result.from_reference, result.two_sided}) {
    EXPECT_NEAR(s.mean, 0.25, 1e-15);
    EXPECT_NEAR(s.rms, 0.25, 1e-15);
    EXPECT_NEAR(s.p95, 0.25, 1e-15);
    EXPECT_NEAR(s.max, 0.25, 1e-15);
  }
  EXPECT_NEAR(result.normal_consistency, 1, 1e-15);
  EXPECT_DOUBLE_EQ(result.reference_diagonal, std::sqrt(2.0));
  EXPECT_EQ(result.f_score, 0);  // 0.25 is beyond 1 % of the diagonal
}

TEST(Compare, GivesTheDifferenceOfTheRadiiOfConcentricSpheres) {
  // An icosphere of 5 subdivisions has edges below 0.04: its faces sag by less than 0.04^2 / 6 = 3e-4 of the radius.
  const MeshComparison result = compare(icosphere_mesh(5, 1.1), icosphere_mesh(5, 1.0), with(20'000));
  EXPECT_NEAR(result.to_reference.mean, 0.1, 4e-4);
  EXPECT_NEAR(result.from_reference.mean, 0.1, 4e-4);
  EXPECT_NEAR(result.two_sided.max, 0.1, 8e-4);
  EXPECT_GT(result.normal_consistency, 0.999);
}

TEST(Compare, TellsAccuracyFromCompleteness) {
  // Half of the reference is missing: everything there is is right, half of what should be there is not.
  const Mesh half = patch_mesh(1, 1);
  Mesh whole = half;
  test::append(whole, test::translated(half, {10, 0, 0}));
  const MeshComparison result = compare(half, whole, with(10'000));
  EXPECT_EQ(result.precision, 1);
  EXPECT_NEAR(result.recall, 0.5, 0.02);  // samples of the far patch are at least 9 away; tau is 0.11
  EXPECT_NEAR(result.f_score, 2 * result.recall / (1 + result.recall), 1e-15);
  EXPECT_LT(result.to_reference.max, 1e-15);
  // From x in [10, 11] to the border at x = 1: 9 to 10, uniform; the 95th percentile of all is the 90th of those.
  EXPECT_NEAR(result.from_reference.p95, 9.9, 0.01);
  EXPECT_NEAR(result.from_reference.mean, 0.5 * 9.5, 0.02);
  EXPECT_NEAR(result.two_sided.mean, result.from_reference.mean / 2, 1e-15);
  EXPECT_NEAR(result.two_sided.rms, result.from_reference.rms / std::sqrt(2.0), 1e-12);
}

TEST(Compare, IgnoresTheSideNormalsPointTo) {
  const MeshComparison result = compare(test::flipped(icosphere_mesh(3)), icosphere_mesh(3), with(2'000));
  EXPECT_NEAR(result.normal_consistency, 1, 1e-12);
}

TEST(Compare, ComparesInWorldCoordinates) {
  // The same box near (5e6, 4e5, 0), once stored about another origin. All numbers are exact in float and double.
  Mesh mesh = box_mesh();
  mesh.origin = {5e6, 4e5, 0};
  Mesh reference = box_mesh({-2, -3, 0.5}, {-1, -2, 1.5});
  reference.origin = {5e6 + 2, 4e5 + 3, -0.5};
  EXPECT_LT(compare(mesh, reference, with(5'000)).two_sided.max, 1e-12);
  reference.origin[2] += 0.125;
  // Sides of the boxes shift in their own planes; only tops and bottoms part, by 1/8.
  EXPECT_NEAR(compare(mesh, reference, with(5'000)).two_sided.max, 0.125, 1e-9);
}

TEST(Compare, AcceptsMeshesWithoutArea) {
  Mesh segment;
  segment.vertices = {{0, 0, 3}, {1, 0, 3}};
  segment.triangles = {{0, 1, 1}};
  const MeshComparison result = compare(segment, patch_mesh(1), with(100));
  EXPECT_NEAR(result.to_reference.max, 3, 1e-15);
  EXPECT_EQ(result.normal_consistency, 0);
}

TEST(Compare, RejectsWhatItCannotCompare) {
  const Mesh good = box_mesh();
  EXPECT_EQ(code_of(Mesh{}, good), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(good, Mesh{}), ErrorCode::invalid_input);
  Mesh bad_index = good;
  bad_index.triangles[0][0] = 8;
  EXPECT_EQ(code_of(bad_index, good), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(good, bad_index), ErrorCode::invalid_input);
  Mesh not_finite = good;
  not_finite.vertices[3].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code_of(not_finite, good), ErrorCode::invalid_input);
}

TEST(Compare, RejectsOptionsOutOfRange) {
  const Mesh good = box_mesh();
  EXPECT_EQ(code_of(good, good, {0, 0.01, 0}), ErrorCode::usage);
  EXPECT_EQ(code_of(good, good, {-5, 0.01, 0}), ErrorCode::usage);
  EXPECT_EQ(code_of(good, good, {100, 0, 0}), ErrorCode::usage);
  EXPECT_EQ(code_of(good, good, {100, std::numeric_limits<double>::quiet_NaN(), 0}), ErrorCode::usage);
  EXPECT_EQ(code_of(good, good, {100, 0.01, -1}), ErrorCode::usage);
}

TEST(Compare, GivesTheSameBitsForAnyNumberOfThreads) {
  const Mesh mesh = icosphere_mesh(4), reference = test::torus_mesh(50, 30, 0.8, 0.3);
  const MeshComparison one = compare(mesh, reference, with(10'000, 1));
  for (const int threads : {2, 5}) {
    const MeshComparison many = compare(mesh, reference, with(10'000, threads));
    EXPECT_EQ(many.two_sided.mean, one.two_sided.mean) << threads;
    EXPECT_EQ(many.two_sided.rms, one.two_sided.rms) << threads;
    EXPECT_EQ(many.to_reference.p95, one.to_reference.p95) << threads;
    EXPECT_EQ(many.from_reference.max, one.from_reference.max) << threads;
    EXPECT_EQ(many.normal_consistency, one.normal_consistency) << threads;
    EXPECT_EQ(many.f_score, one.f_score) << threads;
  }
}

}  // namespace
}  // namespace pointskin
