// The parts of the envelope against the signed distance of every single point.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/vec3.hpp"
#include "envelope/envelope.hpp"
#include "exec/cpu.hpp"
#include "mesh/signed_distance.hpp"
#include "support/shapes.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using namespace mesh_detail;
using envelope::Envelope;

/// A torus in a cube of side 4 whose lower corner is at (-2, -2, -2) off the origin of a cloud.
struct Fixture {
  std::shared_ptr<const Mesh> mesh = std::make_shared<const Mesh>(test::torus_mesh(48, 24));
  octree::Frame frame{{-2, -2, -2}, 4};
  Envelope envelope{mesh, {0, 0, 0}, 3};
  exec::Cpu ex{1};
  SignedDistance distance{ex, *mesh, {0, 0, 0}};

  [[nodiscard]] Vec3d world(const Vec3f& unit) const { return frame.lower + frame.size * to_double(unit); }
  [[nodiscard]] double signed_distance(const Vec3f& unit) const { return distance.at(world(unit)).distance; }
};

std::vector<Vec3f> random_points(int n, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Vec3f> points;
  for (int i = 0; i < n; ++i)
    points.push_back({static_cast<float>(random.unit()), static_cast<float>(random.unit()),
                      static_cast<float>(random.in(0.35, 0.65))});
  return points;
}

template <class T>
ArrayView<const T> view_of(const std::vector<T>& v) {
  return {v.data(), static_cast<std::int64_t>(v.size())};
}
template <class T>
ArrayView<T> view_of(std::vector<T>& v) {
  return {v.data(), static_cast<std::int64_t>(v.size())};
}

TEST(EnvelopeParts, DropsTheSamplesOutsideAndCountsThem) {
  const Fixture f;
  const std::vector<Vec3f> points = random_points(20'000, 1);
  std::vector<float> areas(points.size(), 2);
  const std::int64_t outside = f.envelope.drop_outside(f.frame, view_of(points), view_of(areas));
  std::int64_t expected = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_outside = f.signed_distance(points[i]) < -envelope::kTolerance * f.frame.size;
    expected += is_outside ? 1 : 0;
    ASSERT_EQ(areas[i], is_outside ? 0 : 2);
  }
  EXPECT_EQ(outside, expected);
  EXPECT_GT(outside, 1000);
  EXPECT_LT(outside, 19'000);
}

TEST(EnvelopeParts, HoldsTheCornersOutsideAndNoOthers) {
  const Fixture f;
  test::Random random(2);
  const test::SmallTree tree(test::clustered_points(random, 20, 100, 0.1), {}, 7);
  std::int64_t held = 0, free_corners = 0;
  for (int d = 0; d <= 7; ++d) {
    const octree::LevelView& level = tree.view.levels[d];
    std::vector<std::uint8_t> free(level.unknowns, level.unknowns + level.bricks);
    f.envelope.hold_outside(f.frame, level, free.data());
    const float width = 1.0F / static_cast<float>(1 << d);
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const bool is_free = (free[static_cast<std::size_t>(n >> 3)] >> (n & 7) & 1) != 0;
      const octree::Coordinates c = test::corner_at(level, n);
      const Vec3f unit{static_cast<float>(c.x) * width, static_cast<float>(c.y) * width,
                       static_cast<float>(c.z) * width};
      const double margin = envelope::kCornerMargin * f.frame.size * static_cast<double>(width);
      ASSERT_EQ(is_free, test::is_unknown(level, n) && f.signed_distance(unit) > margin) << "level " << d;
      if (is_free) ++free_corners;
      if (!is_free && test::is_unknown(level, n)) ++held;
    }
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(free_corners, 1000);
}

TEST(EnvelopeParts, MovesVerticesAlongTheirEdgesOntoTheEnvelopeAndLeavesAllOthers) {
  const Fixture f;
  const double tolerance = envelope::kTolerance * f.frame.size;
  const std::vector<Vec3f> ends = random_points(20'000, 3);
  std::vector<Vec3f> vertices = ends;
  test::Random random(4);
  for (Vec3f& v : vertices) {
    float* const along[3] = {&v.x, &v.y, &v.z};
    *along[random.below(3)] += static_cast<float>(random.in(-0.1, 0.1));
  }
  const std::vector<Vec3f> before = vertices;
  const envelope::Moved moved = f.envelope.clip(f.frame, view_of(vertices), view_of(ends));
  std::int64_t expected = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (f.signed_distance(before[i]) >= -tolerance || f.signed_distance(ends[i]) <= 0) {
      ASSERT_EQ(length(to_double(vertices[i]) - to_double(before[i])), 0);
      continue;
    }
    ++expected;
    ASSERT_NEAR(f.signed_distance(vertices[i]), 0, tolerance);
    const Vec3d whole = to_double(before[i]) - to_double(ends[i]);
    const Vec3d part = to_double(vertices[i]) - to_double(ends[i]);
    ASSERT_LT(length(cross(whole, part)), 1e-7 * length(whole));  // on the line
    ASSERT_GT(dot(whole, part), 0);
    ASSERT_LE(length(part), length(whole));
  }
  EXPECT_EQ(moved.vertices, expected);
  EXPECT_GT(expected, 500);
  EXPECT_GT(moved.farthest, 0.01);
  EXPECT_LT(moved.farthest, 0.4);
}

TEST(EnvelopeParts, ProjectsWhatIsOutsideToTheNearestPoint) {
  const Fixture f;
  const double tolerance = envelope::kTolerance * f.frame.size;
  std::vector<Vec3f> vertices = random_points(20'000, 5);
  const std::vector<Vec3f> before = vertices;
  const envelope::Moved moved = f.envelope.project(f.frame, view_of(vertices));
  std::int64_t expected = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double distance = f.signed_distance(before[i]);
    const double way = f.frame.size * length(to_double(vertices[i]) - to_double(before[i]));
    ASSERT_NEAR(way, distance < -tolerance ? -distance : 0, tolerance);
    ASSERT_GT(f.signed_distance(vertices[i]), -tolerance);
    expected += distance < -tolerance ? 1 : 0;
  }
  EXPECT_EQ(moved.vertices, expected);
  EXPECT_EQ(f.envelope.project(f.frame, view_of(vertices)).vertices, 0) << "twice is once";
}

TEST(EnvelopeParts, AreTheSameForAnyNumberOfThreads) {
  const Fixture f;
  const Envelope alone(f.mesh, {0, 0, 0}, 1);
  std::vector<Vec3f> a = random_points(20'000, 6), b = a;
  const envelope::Moved moved_a = f.envelope.project(f.frame, view_of(a));
  const envelope::Moved moved_b = alone.project(f.frame, view_of(b));
  EXPECT_EQ(moved_a.farthest, moved_b.farthest);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]);
}

}  // namespace
}  // namespace pointskin
