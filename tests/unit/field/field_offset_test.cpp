// Samples on triangles, distances to them, and the field of an offset, against their definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "field/offset.hpp"
#include "field/triangle_samples.hpp"
#include "mesh/triangle_distance.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using field::offset::squared_to_triangle;

Vec3f point_in(test::Random& random, double size) {
  return {static_cast<float>(random.in(-size, size)), static_cast<float>(random.in(-size, size)),
          static_cast<float>(random.in(-size, size))};
}
Vec3d in_double(const Vec3f& p) { return {p.x, p.y, p.z}; }

double expected_squared(const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return mesh_detail::squared_distance(in_double(q),
                                       {in_double(a), in_double(b) - in_double(a), in_double(c) - in_double(a)});
}

TEST(SquaredToTriangle, IsThatOfTheNearestFeature) {
  test::Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3f a = point_in(random, 1), b = point_in(random, 1), c = point_in(random, 1), q = point_in(random, 2);
    ASSERT_NEAR(squared_to_triangle(q, a, b, c), expected_squared(q, a, b, c), 1e-12);
  }
}

TEST(SquaredToTriangle, TakesTrianglesWithoutArea) {
  const Vec3f a{0, 0, 0}, b{1, 0, 0}, middle{0.25F, 0, 0};
  EXPECT_DOUBLE_EQ(squared_to_triangle({0.5F, 2, 0}, a, b, middle), 4);
  EXPECT_DOUBLE_EQ(squared_to_triangle({-3, 4, 0}, a, a, a), 25);
  EXPECT_DOUBLE_EQ(squared_to_triangle({2, 0, 0}, a, a, b), 1);
}

/// Distance of q to the mesh by trying all triangles.
double brute_distance(const Mesh& mesh, const Vec3f& q) {
  double least = 1e300;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    least = std::min(least, expected_squared(q, corner(0), corner(1), corner(2)));
  }
  return std::sqrt(least);
}

field::offset::Corners corners_of(const Mesh& mesh) {
  return {{mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size())},
          {mesh.triangles.data(), static_cast<std::int64_t>(mesh.triangles.size())}};
}

TEST(LaySamples, CoversEveryTriangle) {
  // Large triangles and small ones, at cells of 1/32.
  Mesh mesh = test::icosphere_mesh(1, 0.4, {0.5, 0.5, 0.5});
  test::append(mesh, test::icosphere_mesh(4, 0.1, {0.5, 0.5, 0.5}));
  exec::Cpu ex(2);
  const field::offset::TriangleSamples samples = field::offset::lay_samples(ex, corners_of(mesh), 5, 1);
  const double cell = 1.0 / 32;
  test::Random random(2);
  for (int i = 0; i < 2'000; ++i) {
    const auto t = static_cast<std::size_t>(random.below(static_cast<std::int64_t>(mesh.triangles.size())));
    double u = random.unit(), v = random.unit();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])]; };
    const Vec3f a = corner(0), b = corner(1), c = corner(2);
    const auto mix = [&](float x, float y, float z) { return x + u * (y - x) + v * (z - x); };
    const double p[3] = {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z)};
    double least = 1e300;
    for (std::int64_t s = 0; s < samples.positions.size(); ++s) {
      if (samples.owners.data()[s] != static_cast<std::int32_t>(t)) continue;
      const Vec3f q = samples.positions.data()[s];
      least = std::min(least, std::hypot(q.x - p[0], q.y - p[1], q.z - p[2]));
    }
    ASSERT_LT(least, 0.463 * cell);
  }
  for (std::int64_t s = 0; s < samples.positions.size(); ++s) {
    const auto t = static_cast<std::size_t>(samples.owners.data()[s]);
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])]; };
    ASSERT_LT(expected_squared(samples.positions.data()[s], corner(0), corner(1), corner(2)), 1e-14);
  }
}

TEST(SurfaceDistance, IsTooLargeByWhatSamplesAreApartAtMost) {
  const Mesh mesh = test::torus_mesh(40, 20, 0.3, 0.1);
  Mesh moved = mesh;
  for (Vec3f& v : moved.vertices) v = {v.x + 0.5F, v.y + 0.5F, v.z + 0.5F};
  exec::Cpu ex(2);
  const field::offset::TriangleSamples samples = field::offset::lay_samples(ex, corners_of(moved), 6, 1);
  const field::offset::SurfaceDistance distance{samples.tree.view(), samples.positions.cview(), samples.owners.cview(),
                                                corners_of(moved)};
  const double cell = 1.0 / 64;
  test::Random random(3);
  for (int i = 0; i < 300; ++i) {
    const Vec3f centred = point_in(random, 0.5);
    const Vec3f q{centred.x + 0.5F, centred.y + 0.5F, centred.z + 0.5F};
    const double found = std::sqrt(distance.squared(q)), truth = brute_distance(moved, q);
    ASSERT_GE(found, truth - 1e-9);
    ASSERT_LE(found, truth + 0.47 * cell);
  }
}

/// An offset of s cells has pieces w = sqrt(s / 2) times as large, and distances too large by 0.46^2 w^2 / (2 s) cells.
TEST(SurfaceDistance, OfCoarseSamplesIsAlmostRightFarAway) {
  constexpr double kOffsetCells = 12;
  constexpr double kWider = 2.449;
  const Mesh mesh = test::torus_mesh(40, 20, 0.25, 0.08);
  Mesh moved = mesh;
  for (Vec3f& v : moved.vertices) v = {v.x + 0.5F, v.y + 0.5F, v.z + 0.5F};
  exec::Cpu ex(2);
  const auto samples = field::offset::lay_samples(ex, corners_of(moved), 6, kWider);
  EXPECT_LT(samples.positions.size(), field::offset::lay_samples(ex, corners_of(moved), 6, 1).positions.size());
  const field::offset::SurfaceDistance distance{samples.tree.view(), samples.positions.cview(), samples.owners.cview(),
                                                corners_of(moved), true};
  const double cell = 1.0 / 64;
  test::Random random(3);
  int far = 0;
  for (int i = 0; i < 1'000; ++i) {
    const Vec3f centred = point_in(random, 0.5);
    const Vec3f q{centred.x + 0.5F, centred.y + 0.5F, centred.z + 0.5F};
    const double truth = brute_distance(moved, q);
    if (truth < kOffsetCells * cell) continue;
    ++far;
    const double found = std::sqrt(distance.squared(q));
    ASSERT_GE(found, truth - 1e-9);
    ASSERT_LE(found, truth + 0.06 * cell);
  }
  EXPECT_GT(far, 100);
}

}  // namespace
}  // namespace pointskin
