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
#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::reconstructed;

Options weakness_options(int depth) {
  Options options{{.depth = depth}};
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
  expect_same_bytes(with, Reconstructor(Device::cpu(3)).solve(test::shuffled(cloud, 4), options, {}).extract(options));
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

double angle_degrees(const ProblemView& a, const ProblemView& b) {
  double cosine = 0;
  for (std::size_t k = 8; k < 11; ++k) cosine += a.matrix[k] * b.matrix[k];
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::acos(-1.0);
}

TEST(FindProblems, ViewsDifferByFortyDegreesAndSeeThePlace) {
  const std::vector<ProblemRegion> regions =
      find_problems(reconstructed(two_fingers(60'000, 1), weakness_options(7)), {.up = UpAxis::z});
  ASSERT_FALSE(regions.empty());
  for (const ProblemRegion& region : regions) {
    ASSERT_EQ(region.views.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_GE(region.views[i].visible, 0.05);
      EXPECT_GE(region.views[i].zoom, 1);
      for (std::size_t j = 0; j < i; ++j) EXPECT_GE(angle_degrees(region.views[i], region.views[j]), 39.9);
    }
  }
}

/// A weak square at the origin that faces +z, and a wall in front of it, which leaves only sides free.
Mesh behind_a_wall(bool wall) {
  Mesh mesh = test::translated(test::patch_mesh(4, 0.4), {-0.2F, -0.2F, 0});
  const std::size_t weak = mesh.vertices.size();
  if (wall) test::append(mesh, test::translated(test::patch_mesh(4, 1), {-0.5F, -0.5F, 0.6F}));
  std::vector<float> weakness(weak, 0.8F);
  weakness.resize(mesh.vertices.size(), 0);
  mesh.attributes = {{"weakness", weakness}};
  return mesh;
}

TEST(FindProblems, ViewsLookPastWhatIsInTheWay) {
  const ProblemRegion free = find_problems(behind_a_wall(false)).at(0);
  EXPECT_NEAR(free.views.at(0).azimuth_degrees, 0, 1e-9);
  EXPECT_NEAR(free.views.at(0).elevation_degrees, 0, 1e-9);
  EXPECT_EQ(free.views.at(0).visible, 1);
  const ProblemRegion hidden = find_problems(behind_a_wall(true)).at(0);
  ASSERT_EQ(hidden.views.size(), 3U);
  for (const ProblemView& view : hidden.views) {
    // The wall reaches 0.5 to either side at a height of 0.6: the middle is seen from 40 degrees off the normal on.
    EXPECT_LT(view.matrix[10], std::cos(35 * std::acos(-1.0) / 180));
    EXPECT_GT(view.visible, 0.3);
  }
}

TEST(FindProblems, ViewsThatWouldSeeNothingAreLeftOut) {
  // At the bottom of a deep shaft: only along it.
  Mesh mesh = behind_a_wall(false);
  Mesh shaft = test::box_mesh({-0.21, -0.21, -0.01}, {0.21, 0.21, 3});
  shaft.triangles.erase(std::remove_if(shaft.triangles.begin(), shaft.triangles.end(),
                                       [&](const Triangle& t) {
                                         return std::all_of(t.begin(), t.end(), [&](std::int32_t id) {
                                           return shaft.vertices[static_cast<std::size_t>(id)].z > 1;
                                         });
                                       }),
                        shaft.triangles.end());
  mesh.attributes[0].values.append(std::vector<float>(shaft.vertices.size(), 0));
  const std::vector<Attribute> kept = mesh.attributes;
  mesh.attributes.clear();
  test::append(mesh, shaft);
  mesh.attributes = kept;
  const ProblemRegion region = find_problems(mesh).at(0);
  EXPECT_EQ(region.views.size(), 1U);
  EXPECT_GT(region.views[0].visible, 0.9);
}

TEST(FindProblems, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = reconstructed(two_fingers(30'000, 1), weakness_options(6));
  const std::vector<ProblemRegion> one = find_problems(mesh, {.threads = 1}),
                                   four = find_problems(mesh, {.threads = 4});
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t r = 0; r < one.size(); ++r)
    for (std::size_t v = 0; v < one[r].views.size(); ++v) {
      EXPECT_EQ(one[r].views[v].matrix, four[r].views[v].matrix);
      EXPECT_EQ(one[r].views[v].visible, four[r].views[v].visible);
    }
}

TEST(RenderProblem, ShowsTheRegionTintedInTheMiddleAndARingAroundIt) {
  const Mesh mesh = behind_a_wall(true);
  const ProblemRegion region = find_problems(mesh).at(0);
  RenderOptions options;
  options.width = 400;
  options.height = 300;
  for (std::size_t v = 0; v < region.views.size(); ++v) {
    const Image image = render_problem(mesh, region, v, options);
    const test::Rgb at = test::middle(image);
    EXPECT_GT(at[0], at[1] + 40) << v;  // orange to magenta; clay is grey
    int white = 0;
    for (int y = 0; y < 300; ++y)
      for (int x = 0; x < 400; ++x) {
        const double r = std::hypot(x + 0.5 - 200, y + 0.5 - 150);
        if (r > 50 && r < 142 && test::lightness(test::pixel(image, x, y)) > 240) ++white;
      }
    EXPECT_GT(white, 100) << v;
    EXPECT_NE(render_problem(mesh, region, v, options, "problem 1").rgb, image.rgb);
  }
  EXPECT_EQ(error_of([&] { (void)render_problem(mesh, region, 3, options); }), ErrorCode::usage);
  EXPECT_EQ(error_of([&] { (void)render_problem(test::box_mesh(), region, 0, options); }), ErrorCode::usage);
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
