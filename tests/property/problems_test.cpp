// The problem finder: where the topology is doubtful, and nowhere else.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/problems.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::reconstructed;

Options weakness_options(int depth) {
  Options options{.depth = depth};
  options.weakness = true;
  return options;
}

constexpr double kGap = 0.08;

/// Two fingers along z, side by side along x, `kGap` apart: what faces the other one is not sampled.
Cloud two_fingers(std::int64_t n, std::uint64_t seed) {
  Cloud both = test::box_cloud(n / 2, seed, {-0.4 - kGap / 2, -0.2, -1}, {-kGap / 2, 0.2, 1});
  test::append(both, test::box_cloud(n / 2, seed + 1, {kGap / 2, -0.2, -1}, {0.4 + kGap / 2, 0.2, 1}));
  Cloud open;
  for (std::size_t i = 0; i < both.positions.size(); ++i) {
    if (std::abs(both.positions[i].x) < kGap / 2 + 0.001) continue;
    open.positions.push_back(both.positions[i]);
    open.normals.push_back(both.normals[i]);
  }
  return open;
}

TEST(Problems, FindsWhereTwoFingersAreJoined) {
  const Mesh mesh = reconstructed(two_fingers(60'000, 1), weakness_options(7));
  ASSERT_EQ(measure(mesh).components, 1);  // joined, as nothing says that they are two
  ASSERT_EQ(mesh.attributes.size(), 1U);
  EXPECT_EQ(mesh.attributes[0].name, "weakness");
  for (const float w : mesh.attributes[0].values.as<float>()) ASSERT_TRUE(w >= 0 && w <= 1);
  const std::vector<ProblemRegion> regions = find_problems(mesh);
  ASSERT_FALSE(regions.empty());
  const ProblemRegion& worst = regions.front();
  EXPECT_NEAR(worst.centroid_world[0], 0, kGap);
  EXPECT_GT(worst.lower_world[0], -2 * kGap);
  EXPECT_LT(worst.upper_world[0], 2 * kGap);
  EXPECT_GT(worst.upper_world[2] - worst.lower_world[2], 0.5);  // all along the fingers
  for (std::size_t i = 1; i < regions.size(); ++i) EXPECT_GE(regions[i - 1].score, regions[i].score);
}

TEST(Problems, AreNoneOnAWellSampledSphere) {
  EXPECT_TRUE(find_problems(reconstructed(test::sphere_cloud(100'000, 2), weakness_options(7))).empty());
}

TEST(Problems, WeaknessComesLastAndLeavesAllElseAsItIs) {
  const Cloud cloud = test::torus_cloud(5'000, 3);
  Options options = weakness_options(6);
  options.density = true;
  Mesh with = reconstructed(cloud, options);
  ASSERT_EQ(with.attributes.size(), 2U);
  EXPECT_EQ(with.attributes[1].name, "weakness");
  expect_same_bytes(with, Reconstructor(Device::cpu(3)).solve(test::shuffled(cloud, 4), options).extract());
  with.attributes.pop_back();
  options.weakness = false;
  expect_same_bytes(with, reconstructed(cloud, options));
}

/// A strip of squares along x, weak where `weak` says so.
Mesh strip(int squares, const std::vector<int>& weak) {
  Mesh mesh;
  std::vector<float> weakness;
  for (int i = 0; i <= squares; ++i)
    for (int k = 0; k < 2; ++k) {
      mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(k), 0});
      const bool is_weak = std::find(weak.begin(), weak.end(), i) != weak.end();
      weakness.push_back(is_weak ? 0.5F : 0.0F);
    }
  for (int i = 0; i < squares; ++i) {
    const std::int32_t a = 2 * i;
    mesh.triangles.push_back({a, a + 2, a + 1});
    mesh.triangles.push_back({a + 1, a + 2, a + 3});
  }
  mesh.origin = {100, 0, 0};
  mesh.attributes.push_back({"weakness", std::move(weakness)});
  return mesh;
}

TEST(FindProblems, MeasuresAndRanksRegions) {
  // Weak columns of vertices at 2..3 and 10..13: one square, and three.
  const std::vector<ProblemRegion> regions =
      find_problems(strip(20, {2, 3, 10, 11, 12, 13}), {.threshold = 0.45, .least_area = 0});
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_DOUBLE_EQ(regions[0].area, 3);
  EXPECT_DOUBLE_EQ(regions[0].score, 1.5);
  EXPECT_DOUBLE_EQ(regions[0].peak, 0.5);
  EXPECT_EQ(regions[0].triangles, 6);
  EXPECT_NEAR(regions[0].centroid_world[0], 111.5, 1e-12);
  EXPECT_EQ(regions[0].lower_world, (Vec3d{110, 0, 0}));
  EXPECT_EQ(regions[0].upper_world, (Vec3d{113, 1, 0}));
  EXPECT_NEAR(regions[0].mean_normal[2], 1, 1e-12);
  EXPECT_DOUBLE_EQ(regions[1].area, 1);
  // The first view looks along the normal: from the front.
  ASSERT_EQ(regions[0].views.size(), 3U);
  const ProblemView& view = regions[0].views[0];
  EXPECT_NEAR(view.azimuth_degrees, 0, 1e-9);
  EXPECT_NEAR(view.elevation_degrees, 0, 1e-9);
  const auto seen = [&](const Vec3d& p, std::size_t row) {
    const double* m = view.matrix.data() + 4 * row;
    return m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
  };
  EXPECT_NEAR(seen(view.target_world, 0), 0, 1e-9);
  EXPECT_NEAR(seen(view.target_world, 1), 0, 1e-9);
  EXPECT_LT(seen(view.target_world, 2), -1.5);
  EXPECT_GT(seen({112, 0.5, 1}, 2), seen(view.target_world, 2));  // nearer to the viewer
}

TEST(FindProblems, ThresholdAndLeastAreaDecide) {
  const Mesh mesh = strip(20, {2, 3, 10, 11, 12, 13});
  EXPECT_EQ(find_problems(mesh, {.threshold = 0.6}).size(), 0U);
  EXPECT_EQ(find_problems(mesh, {.threshold = 0.45, .least_area = 0.1}).size(), 1U);
}

TEST(FindProblems, RefusesWhatItCannotUse) {
  Mesh mesh = strip(3, {1});
  EXPECT_EQ(error_of([&] { (void)find_problems(mesh, {.threshold = 0}); }), ErrorCode::usage);
  EXPECT_EQ(error_of([&] { (void)find_problems(mesh, {.least_area = 2}); }), ErrorCode::usage);
  mesh.triangles.push_back({0, 1, 99});
  EXPECT_EQ(error_of([&] { (void)find_problems(mesh); }), ErrorCode::invalid_input);
  EXPECT_EQ(error_of([&] { (void)find_problems(test::box_mesh()); }), ErrorCode::usage);
}

}  // namespace
}  // namespace pointskin
