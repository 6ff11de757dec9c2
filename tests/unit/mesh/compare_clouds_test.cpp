// Comparisons in which clouds take part, and distances of all points.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu.hpp"
#include "mesh/point_tree.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::Random;

/// Points anywhere, some of them twice, on a line or in a clump.
Cloud random_cloud(Random& random, int n) {
  Cloud cloud;
  for (int i = 0; i < n; ++i) {
    Vec3f p{static_cast<float>(random.in(-1, 1)), static_cast<float>(random.in(-1, 1)),
            static_cast<float>(random.in(-1, 1))};
    if (i % 7 == 1) p = cloud.positions.back();
    if (i % 7 == 2) p = {p.x, 0.5F, -0.25F};
    if (i % 7 == 3) p = {0.001F * p.x, 0.001F * p.y, 0.001F * p.z};
    cloud.positions.push_back(p);
  }
  return cloud;
}

double searched_distance(const Cloud& cloud, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3f& q : cloud.positions) best = std::min(best, length(p - to_double(q)));
  return best;
}

ErrorCode code_of(const ComparedSurface& surface, const ComparedSurface& reference) {
  try {
    compare(surface, reference);
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode{0};
}

TEST(PointTree, AgreesWithASearchThroughAllPoints) {
  exec::Cpu ex(2);
  for (const int n : {1, 2, 4, 5, 9, 257, 3000}) {
    Random random(static_cast<std::uint64_t>(n));
    const Cloud cloud = random_cloud(random, n);
    const Vec3d offset{0.25, -3, 0.5};
    const mesh_detail::PointTree tree(ex, cloud.positions, offset);
    for (int query = 0; query < 300; ++query) {
      const Vec3d p{random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)};
      const mesh_detail::Nearest found = tree.nearest(p + offset);
      ASSERT_NEAR(std::sqrt(found.squared_distance), searched_distance(cloud, p), 1e-14) << n << ", " << query;
      const auto hint = static_cast<std::int32_t>(random.below(n));
      ASSERT_EQ(tree.nearest(p + offset, hint).slot, found.slot) << n << ", " << query;
    }
  }
}

TEST(PointTree, GivesOfSeveralPointsAtOneDistanceTheFirst) {
  exec::Cpu ex(1);
  const std::vector<Vec3f> points{{3, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const mesh_detail::PointTree tree(ex, points, {0, 0, 0});
  EXPECT_EQ(tree.id(tree.nearest({0, 0, 0}).slot), 1);
  EXPECT_EQ(tree.id(tree.nearest({1, 0, 0}).slot), 1);
}

TEST(CompareClouds, OfACloudWithItselfIsZero) {
  const Cloud cloud = test::sphere_cloud(3000, 1);
  const MeshComparison result = compare(cloud, cloud);
  EXPECT_EQ(result.two_sided.max, 0);
  EXPECT_EQ(result.f_score, 1);
  EXPECT_TRUE(result.has_normals);
  EXPECT_NEAR(result.normal_consistency, 1, 1e-6);  // of normals in float
  EXPECT_EQ(result.samples, 3000);
  EXPECT_EQ(result.reference_samples, 3000);
}

TEST(CompareClouds, GivesTheOffsetOfAGridOfPoints) {
  // Both clouds are the corners of the same grid of width 1/8, one lifted by 1/4: the nearest is right below.
  Cloud low;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) low.positions.push_back({static_cast<float>(i) / 8, static_cast<float>(j) / 8, 0});
  Cloud high = low;
  for (Vec3f& p : high.positions) p.z = 0.25F;
  const MeshComparison result = compare(high, low);
  for (const DistanceStatistics& s : {result.to_reference, result.from_reference, result.two_sided}) {
    EXPECT_EQ(s.mean, 0.25);
    EXPECT_EQ(s.p95, 0.25);
    EXPECT_EQ(s.max, 0.25);
  }
  EXPECT_DOUBLE_EQ(result.reference_diagonal, std::sqrt(2.0));
  EXPECT_FALSE(result.has_normals);
  EXPECT_EQ(result.normal_consistency, 0);
  EXPECT_EQ(result.f_score, 0);  // 0.25 is beyond 1 % of the diagonal
}

TEST(CompareClouds, MeasuresPointsToTrianglesAndSamplesToPoints) {
  // One point at height 1/2 over the middle of a unit square: 1/2 to the mesh; from the mesh, between 1/2 and the
  // distance of a corner, in the mean that of a uniform point of the square.
  Cloud point;
  point.positions = {{0.5F, 0.5F, 0.5F}};
  point.normals = {{0, 0, 2}};
  const Mesh square = test::patch_mesh(4);
  const MeshComparison result = compare(point, square, {.samples = 20'000});
  EXPECT_EQ(result.samples, 1);
  EXPECT_EQ(result.reference_samples, 20'000);
  EXPECT_DOUBLE_EQ(result.to_reference.mean, 0.5);
  EXPECT_NEAR(result.from_reference.max, std::sqrt(0.75), 0.01);
  EXPECT_NEAR(result.from_reference.rms, std::sqrt(0.25 + 1.0 / 6), 1e-3);  // 1/4 + 2 Var of a coordinate
  EXPECT_DOUBLE_EQ(result.normal_consistency, 1);

  Cloud corners = point;
  corners.positions = {{0, 0, 0}, {1, 1, 0}};
  corners.normals.clear();
  const MeshComparison other_way = compare(square, corners, {.samples = 20'000});
  EXPECT_EQ(other_way.samples, 20'000);
  EXPECT_EQ(other_way.from_reference.max, 0);  // the square's own corners
  EXPECT_NEAR(other_way.to_reference.max, 1, 0.01);
  EXPECT_FALSE(other_way.has_normals);
}

TEST(CompareClouds, IgnoresNormalsOfNoLength) {
  Cloud cloud = test::sphere_cloud(100, 2);
  for (std::size_t i = 0; i < 50; ++i) cloud.normals[i] = {0, 0, 0};
  const MeshComparison result = compare(cloud, cloud);
  EXPECT_TRUE(result.has_normals);
  EXPECT_NEAR(result.normal_consistency, 1, 1e-6);
}

TEST(CompareClouds, TakesAnEvenChoiceOfTheSamePointsInAnyOrder) {
  const Cloud cloud = test::sphere_cloud(20'000, 3);
  const Mesh sphere = test::icosphere_mesh(3);
  const CompareOptions options{.samples = 500};
  const MeshComparison some = compare(cloud, sphere, options);
  EXPECT_EQ(some.samples, 500);
  const MeshComparison shuffled = compare(test::shuffled(cloud, 4), sphere, options);
  EXPECT_EQ(shuffled.to_reference.mean, some.to_reference.mean);
  EXPECT_EQ(shuffled.to_reference.max, some.to_reference.max);
  EXPECT_EQ(shuffled.from_reference.rms, some.from_reference.rms);
  EXPECT_EQ(shuffled.normal_consistency, some.normal_consistency);
  // Even: the chosen points stand for all. 500 on a sphere are 0.16 apart, and no point is farther from all of them
  // than a few times that; all points compared with themselves measure it when only 500 of one side are samples.
  Cloud chosen;
  exec::Cpu ex(1);
  const mesh_detail::PointTree tree(ex, cloud.positions, {0, 0, 0});
  for (std::int32_t i = 0; i < 500; ++i) {
    const Vec3d p = tree.point(i * 40);
    chosen.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  EXPECT_LT(compare(cloud, chosen, {.samples = 20'000}).to_reference.max, 0.4);
}

TEST(CompareClouds, WorksInWorldCoordinates) {
  // The same points about origins that are far apart; all numbers are exact in float and double.
  Cloud here;
  for (int i = 0; i < 1000; ++i)
    here.positions.push_back(
        {static_cast<float>(i % 10) / 8, static_cast<float>(i / 10 % 10) / 8, static_cast<float>(i / 100) / 8});
  here.origin = {1e6, 4e6, 250};
  Cloud there = here;
  there.origin = {1e6 + 64, 4e6 - 32, 250.5};
  for (Vec3f& p : there.positions) p = {p.x - 64, p.y + 32, p.z - 0.5F};
  EXPECT_EQ(compare(here, there).two_sided.max, 0);
  there.origin[2] += 0.03125;
  EXPECT_EQ(compare(here, there).two_sided.max, 0.03125);
  Mesh box = test::box_mesh({-64, 32, -0.5}, {-64 + 1.125, 32 + 1.125, -0.5 + 1.125});
  box.origin = {1e6 + 64, 4e6 - 32, 250.5};
  const std::vector<double> inside = distances(here, box, {.with_sign = true});
  EXPECT_EQ(*std::max_element(inside.begin(), inside.end()), 0);
  EXPECT_EQ(*std::min_element(inside.begin(), inside.end()), -0.5);  // the points at 4/8 and 5/8
}

TEST(CompareClouds, GivesTheSameBitsForAnyNumberOfThreads) {
  const Cloud cloud = test::torus_cloud(30'000, 5);
  const Mesh mesh = test::torus_mesh(60, 30);
  const MeshComparison one = compare(cloud, mesh, {.samples = 10'000, .threads = 1});
  const std::vector<double> all = distances(cloud, mesh, {.threads = 1});
  for (const int threads : {2, 5}) {
    const MeshComparison many = compare(cloud, mesh, {.samples = 10'000, .threads = threads});
    EXPECT_EQ(many.to_reference.rms, one.to_reference.rms) << threads;
    EXPECT_EQ(many.from_reference.mean, one.from_reference.mean) << threads;
    EXPECT_EQ(many.normal_consistency, one.normal_consistency) << threads;
    EXPECT_EQ(distances(cloud, mesh, {.threads = threads}), all) << threads;
  }
}

TEST(CompareClouds, RejectsWhatItCannotCompare) {
  const Cloud good = test::sphere_cloud(10, 1);
  EXPECT_EQ(code_of(Cloud{}, good), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(good, Cloud{}), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(good, Mesh{}), ErrorCode::invalid_input);
  Cloud not_finite = good;
  not_finite.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code_of(good, not_finite), ErrorCode::invalid_input);
  Cloud one;
  one.positions = {{1, 2, 3}, {1, 2, 3}};
  EXPECT_EQ(code_of(good, one), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(one, good), ErrorCode{0});
}

TEST(Distances, AreThoseOfEveryVertexInItsOrder) {
  const Mesh outer = test::icosphere_mesh(2, 1.5);
  const std::vector<double> to_box = distances(outer, test::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
  ASSERT_EQ(to_box.size(), outer.vertices.size());
  for (std::size_t i = 0; i < to_box.size(); ++i) {
    const Vec3f& p = outer.vertices[i];
    const auto beyond = [](float x) { return std::max(std::abs(static_cast<double>(x)) - 0.5, 0.0); };
    EXPECT_NEAR(to_box[i], length(Vec3d{beyond(p.x), beyond(p.y), beyond(p.z)}), 1e-14) << i;
  }
  Random random(6);
  const Cloud cloud = random_cloud(random, 500);
  const std::vector<double> to_cloud = distances(outer, cloud);
  for (std::size_t i = 0; i < to_cloud.size(); ++i)
    EXPECT_NEAR(to_cloud[i], searched_distance(cloud, to_double(outer.vertices[i])), 1e-14) << i;
}

TEST(Distances, HaveTheSignOfTheSideWhereAskedFor) {
  Cloud points;
  points.positions = {{0, 0, 0}, {0.75F, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 2, 2}};
  const Mesh box = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  const std::vector<double> with_sign = distances(points, box, {.with_sign = true});
  const std::vector<double> expected{-1, -0.25, 0, 2, std::sqrt(3.0)};
  const std::vector<double> without = distances(points, box);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_DOUBLE_EQ(with_sign[i], expected[i]) << i;
    EXPECT_DOUBLE_EQ(without[i], std::abs(expected[i])) << i;
  }
}

TEST(Distances, HaveNoSignWithoutAnInside) {
  const auto code = [](const ComparedSurface& reference) {
    const Cloud point = test::sphere_cloud(1, 1);
    try {
      distances(point, reference, {.with_sign = true});
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode{0};
  };
  EXPECT_EQ(code(test::patch_mesh(2)), ErrorCode::invalid_input);
  EXPECT_EQ(code(test::flipped(test::box_mesh())), ErrorCode::invalid_input);
  EXPECT_EQ(code(test::sphere_cloud(100, 1)), ErrorCode::invalid_input);
  EXPECT_EQ(code(test::box_mesh()), ErrorCode{0});
}

TEST(Distances, AreUnknownForVerticesThatAreNotFinite) {
  Mesh mesh = test::box_mesh();
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});  // no triangle uses it
  for (const bool with_sign : {false, true}) {
    const std::vector<double> all = distances(mesh, test::icosphere_mesh(1), {.with_sign = with_sign});
    EXPECT_TRUE(std::isnan(all.back()));
    EXPECT_FALSE(std::isnan(all.front()));
  }
}

}  // namespace
}  // namespace pointskin
