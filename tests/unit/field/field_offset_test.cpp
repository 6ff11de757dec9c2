// Distances to one triangle and to the nearest of many, against trying all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/hilbert.hpp"
#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "field/triangle_boxes.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

Vec3f point_in(test::Random& random, double size) {
  return {static_cast<float>(random.in(-size, size)), static_cast<float>(random.in(-size, size)),
          static_cast<float>(random.in(-size, size))};
}
Vec3d in_double(const Vec3f& p) { return {p.x, p.y, p.z}; }

double found_squared(const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return field::offset::PlacedTriangle{a, b, c}.squared_distance(q);
}

double squared_to_segment(const Vec3d& q, const Vec3d& a, const Vec3d& b) {
  const double squared = squared_length(b - a);
  const double t = squared > 0 ? std::clamp(dot(q - a, b - a) / squared, 0.0, 1.0) : 0;
  return squared_length(q - a - t * (b - a));
}

/// The plane's where q is above the inside of all three edges, else that of the nearest edge.
double expected_squared(const Vec3f& at, const Vec3f& first, const Vec3f& second, const Vec3f& third) {
  const Vec3d q = in_double(at), a = in_double(first), b = in_double(second), c = in_double(third);
  const Vec3d n = cross(b - a, c - a);
  const bool above = squared_length(n) > 0 && dot(cross(b - a, q - a), n) > 0 && dot(cross(c - b, q - b), n) > 0 &&
                     dot(cross(a - c, q - c), n) > 0;
  if (above) return dot(q - a, n) * dot(q - a, n) / squared_length(n);
  return std::min({squared_to_segment(q, a, b), squared_to_segment(q, b, c), squared_to_segment(q, c, a)});
}

TEST(SquaredToTriangle, IsThatOfTheNearestFeature) {
  test::Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3f a = point_in(random, 1), b = point_in(random, 1), c = point_in(random, 1), q = point_in(random, 2);
    ASSERT_NEAR(found_squared(q, a, b, c), expected_squared(q, a, b, c), 1e-12);
  }
}

TEST(SquaredToTriangle, TakesTrianglesWithoutArea) {
  const Vec3f a{0, 0, 0}, b{1, 0, 0}, middle{0.25F, 0, 0};
  EXPECT_DOUBLE_EQ(found_squared({0.5F, 2, 0}, a, b, middle), 4);
  EXPECT_DOUBLE_EQ(found_squared({-3, 4, 0}, a, a, a), 25);
  EXPECT_DOUBLE_EQ(found_squared({2, 0, 0}, a, a, b), 1);
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

/// Around the middle of the unit cube.
Mesh moved_to_the_middle(Mesh mesh) {
  for (Vec3f& v : mesh.vertices) v = {v.x + 0.5F, v.y + 0.5F, v.z + 0.5F};
  return mesh;
}

/// At places all over the unit cube, and on corners of triangles, where distances are 0.
void expect_exact(const Mesh& mesh) {
  exec::Cpu ex(2);
  const auto boxes =
      field::offset::make_triangle_boxes(ex, {mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size())},
                                         {mesh.triangles.data(), static_cast<std::int64_t>(mesh.triangles.size())});
  test::Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3f centred = point_in(random, 0.5);
    const Vec3f q{centred.x + 0.5F, centred.y + 0.5F, centred.z + 0.5F};
    const double truth = brute_distance(mesh, q);
    ASSERT_NEAR(std::sqrt(boxes.view().nearest(q).squared), truth, 1e-9);
    const auto start = static_cast<std::int32_t>(random.below(static_cast<std::int64_t>(mesh.triangles.size())));
    ASSERT_NEAR(std::sqrt(boxes.view().nearest(q, start).squared), truth, 1e-9);
    ASSERT_TRUE(boxes.view().is_within(q, truth - 1e-6, truth + 1e-6));
    ASSERT_TRUE(boxes.view().is_within(q, -1, 2));
    ASSERT_FALSE(boxes.view().is_within(q, truth + 1e-6, 2));
    ASSERT_FALSE(boxes.view().is_within(q, -1, truth - 1e-6));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7)
    ASSERT_EQ(boxes.view().nearest(mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][2])]).squared, 0);
}

TEST(TriangleBoxes, FindTheNearestTriangle) { expect_exact(moved_to_the_middle(test::torus_mesh(40, 20, 0.3, 0.1))); }

TEST(TriangleBoxes, OfLargeTrianglesAndSmallOnes) {
  Mesh mesh = test::icosphere_mesh(1, 0.4, {0.5, 0.5, 0.5});
  test::append(mesh, test::icosphere_mesh(4, 0.1, {0.5, 0.5, 0.5}));
  expect_exact(mesh);
}

TEST(TriangleBoxes, OfAnyNumber) {
  const Mesh all = moved_to_the_middle(test::torus_mesh(12, 8, 0.3, 0.1));
  for (const std::size_t count : {1, 2, 3, 4, 5, 8, 9, 16, 17, 31, 33, 64, 65, 127, 192}) {
    SCOPED_TRACE(count);
    Mesh some = all;
    some.triangles.resize(count);
    expect_exact(some);
  }
}

TEST(TriangleBoxes, OfTrianglesThatAreAllTheSame) {
  Mesh mesh = test::icosphere_mesh(1, 0.3, {0.5, 0.5, 0.5});
  mesh.triangles.assign(1'000, mesh.triangles[5]);
  expect_exact(mesh);
}

/// The cells of a cube that is one of a power of two lie together on the curve, and it goes from each to a neighbour.
TEST(HilbertKey, GoesFromCellToNeighbour) {
  constexpr int kCells = 1 << kHilbertBits;
  constexpr int kWide = 16;
  for (const std::array<int, 3>& first : {std::array<int, 3>{0, 0, 0}, {48, 16, 32}, {kCells - kWide, 0, kCells / 2}}) {
    std::vector<std::pair<std::uint64_t, std::array<int, 3>>> cells;
    for (int i = 0; i < kWide * kWide * kWide; ++i) {
      const std::array<int, 3> c{first[0] + i % kWide, first[1] + i / kWide % kWide, first[2] + i / (kWide * kWide)};
      const auto middle = [&](std::size_t a) { return (static_cast<float>(c[a]) + 0.5F) / static_cast<float>(kCells); };
      cells.emplace_back(hilbert_key({middle(0), middle(1), middle(2)}), c);
    }
    std::sort(cells.begin(), cells.end());
    for (std::size_t i = 1; i < cells.size(); ++i) {
      ASSERT_EQ(cells[i].first, cells[i - 1].first + 1);
      int steps = 0;
      for (std::size_t a = 0; a < 3; ++a) steps += std::abs(cells[i].second[a] - cells[i - 1].second[a]);
      ASSERT_EQ(steps, 1) << i;
    }
  }
}

TEST(HilbertKey, MovesPlacesIntoTheCube) {
  EXPECT_EQ(hilbert_key({-3, 0.25F, 0.5F}), hilbert_key({0, 0.25F, 0.5F}));
  EXPECT_EQ(hilbert_key({0.25F, 7, 1e30F}), hilbert_key({0.25F, 0.999999F, 0.999999F}));
  EXPECT_LT(hilbert_key({1, 1, 1}), std::uint64_t{1} << 3 * kHilbertBits);
}

TEST(BoundingDisc, IsNoFartherThanWhatItHolds) {
  test::Random random(5);
  for (int i = 0; i < 2'000; ++i) {
    // From patches that lie about in a plane to triangles all over, from tiny to large, and without area.
    const double size = std::pow(10.0, random.in(-4, 0)), thickness = size * std::pow(10.0, random.in(-3, 0));
    std::vector<field::offset::PlacedTriangle> triangles(1 + static_cast<std::size_t>(i % 9));
    const auto corner = [&] {
      const Vec3f p = point_in(random, size);
      return Vec3f{0.3F + p.x, 0.5F + p.y, 0.4F + p.x + p.y + static_cast<float>(random.in(-thickness, thickness))};
    };
    for (auto& t : triangles) t = {corner(), corner(), corner()};
    if (i % 7 == 0) triangles[0].c = triangles[0].b;
    const auto count = static_cast<std::int64_t>(triangles.size());
    const auto disc = field::offset::disc_around({triangles.data(), count}, 0, count);
    for (int k = 0; k < 20; ++k) {
      const Vec3f away = point_in(random, size * std::pow(10.0, random.in(-1, 2)));
      const Vec3f q{0.3F + away.x, 0.5F + away.y, 0.4F + away.z};
      double least = 1e300;
      for (const auto& t : triangles) least = std::min(least, t.squared_distance(q));
      ASSERT_LE(disc.squared_distance(q), least * (1 + 1e-6) + 1e-12) << i << ' ' << k;
    }
  }
}

TEST(BoundingDisc, StaysThinWhereTrianglesLieAskew) {
  const field::offset::PlacedTriangle triangle{{0.5F, 0.1F, 0.1F}, {0.1F, 0.5F, 0.1F}, {0.1F, 0.1F, 0.5F}};
  const auto disc = field::offset::disc_around({&triangle, 1}, 0, 1);
  EXPECT_LT(disc.half_thickness, 1e-6F);
  EXPECT_NEAR(std::sqrt(disc.squared_distance({0.9F, 0.9F, 0.9F})), (2.7 - 0.7) / std::sqrt(3.0), 1e-6);
}

/// A place near a sphere sees few triangles as near as the nearest one; one that is many of them away, hundreds, but for
/// less than they are wide.
TEST(TriangleBoxes, LookAtFewTrianglesFromAfar) {
  const Mesh mesh = test::icosphere_mesh(6, 0.3, {0.5, 0.5, 0.5});
  exec::Cpu ex(2);
  const auto boxes =
      field::offset::make_triangle_boxes(ex, {mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size())},
                                         {mesh.triangles.data(), static_cast<std::int64_t>(mesh.triangles.size())});
  const field::offset::TriangleBoxesView view = boxes.view();
  test::Random random(7);
  for (const double distance : {0.01, 0.1, -0.1}) {
    std::int64_t looked_at = 0;
    for (int i = 0; i < 1'000; ++i) {
      const Vec3d way = (0.3 + distance) * random.direction();
      const Vec3f q{static_cast<float>(0.5 + way.x), static_cast<float>(0.5 + way.y), static_cast<float>(0.5 + way.z)};
      double least = view.nearest(q).squared;
      view.visit_near(
          q, [&](float squared) { return squared > static_cast<float>(least); },
          [&](double, std::int64_t) { return ++looked_at > 0; });
    }
    EXPECT_LT(looked_at, 60 * 1'000) << distance;
  }
}

}  // namespace
}  // namespace pointskin
