// Connected pieces that are left out.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstdint>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::run;

/// Spheres of radius 1, 0.4 and 0.1, evenly sampled.
Cloud three_spheres() {
  Cloud cloud = test::sphere_cloud(30'000, 1);
  test::append(cloud, test::sphere_cloud(4'800, 2, 0.4, {1.8, 0, 0}));
  test::append(cloud, test::sphere_cloud(1'200, 3, 0.1, {1.8, 0.8, 0}));
  return cloud;
}

TEST(Pieces, OnlyTheLargestStays) {
  const Outcome all = run(three_spheres(), {{.depth = 7}});
  ASSERT_EQ(measure(all.mesh).components, 3);
  const Outcome largest = run(three_spheres(), {{.depth = 7}, {.largest = true}});
  const MeshReport mesh = measure(largest.mesh);
  EXPECT_EQ(mesh.components, 1);
  EXPECT_TRUE(mesh.watertight());
  EXPECT_EQ(mesh.vertices, mesh.used_vertices);
  EXPECT_NEAR(mesh.volume, 4.18879, 0.02);
  EXPECT_EQ(largest.report.pieces.pieces, 3);
  EXPECT_EQ(largest.report.pieces.pieces_removed, 2);
  EXPECT_EQ(largest.report.pieces.triangles_removed, measure(all.mesh).triangles - mesh.triangles);
}

TEST(Pieces, SmallOnesGoByTrianglesOrByArea) {
  // Areas 1, 0.16 and 0.01 of the largest: 0.855, 0.137 and 0.0085 of all.
  const auto pieces = [](double least) {
    return measure(run(three_spheres(), {{.depth = 7}, {.min_component = least}}).mesh).components;
  };
  EXPECT_EQ(pieces(0.001), 3);
  EXPECT_EQ(pieces(0.02), 2);
  EXPECT_EQ(pieces(0.3), 1);
  EXPECT_EQ(pieces(2), 3);
  const std::int64_t triangles = measure(run(three_spheres(), {{.depth = 7}}).mesh).triangles;
  EXPECT_EQ(pieces(static_cast<double>(triangles / 50)), 2);
  EXPECT_EQ(pieces(static_cast<double>(triangles / 2)), 1);
}

/// The sphere of radius 1, with outliers all around that face all ways, and a ball of radius 0.1 with some samples.
Cloud among_outliers(std::int64_t samples_of_ball) {
  Cloud cloud = test::sphere_cloud(30'000, 1);
  test::Random random(9);
  const auto anywhere = [&] { return static_cast<float>(random.in(-1, 1)); };
  for (int i = 0; i < 600; ++i) {
    cloud.positions.push_back({1.6F * anywhere(), 1.6F * anywhere(), 1.6F * anywhere()});
    cloud.normals.push_back({anywhere(), anywhere(), anywhere()});
  }
  if (samples_of_ball > 0) test::append(cloud, test::sphere_cloud(samples_of_ball, 3, 0.1, {1.4, 1.3, 1.2}));
  return cloud;
}

TEST(Pieces, WithoutSamplesGoWhereThereAreOutliers) {
  for (const int depth : {6, 7, 8}) {
    const Outcome outcome = run(among_outliers(0), {{.depth = depth}});
    const MeshReport mesh = measure(outcome.mesh);
    EXPECT_EQ(mesh.components, 1) << depth;
    EXPECT_TRUE(mesh.watertight());
    EXPECT_NEAR(mesh.volume, 4.18879, 0.03);
    EXPECT_EQ(outcome.report.pieces.pieces, outcome.report.pieces.pieces_removed + 1);
  }
}

TEST(Pieces, WithSamplesStayAmongOutliers) {
  EXPECT_EQ(measure(run(among_outliers(400), {{.depth = 7}}).mesh).components, 2);
}

TEST(Pieces, OfACloudWithoutOutliersAllStay) {
  Cloud cloud = test::sphere_cloud(30'000, 1);
  test::append(cloud, test::sphere_cloud(60, 3, 0.05, {1.4, 1.3, 1.2}));  // as dense as the rest
  const Outcome outcome = run(cloud, {{.depth = 8}});
  EXPECT_EQ(outcome.report.pieces.pieces_removed, 0);
}

TEST(Pieces, WhatStaysKeepsItsBytes) {
  const Cloud cloud = three_spheres();
  const Mesh all = run(cloud, {{.depth = 7}, {.density = true}}).mesh;
  expect_same_bytes(run(cloud, {{.depth = 7}, {.min_component = 1, .density = true}}).mesh, all);
  const Outcome some = run(cloud, {{.depth = 7}, {.min_component = 0.02, .density = true}});
  // In the order of the whole, as a subsequence.
  std::size_t at = 0;
  for (const Vec3f& v : some.mesh.vertices) {
    while (at < all.vertices.size() && !(all.vertices[at] == v)) ++at;
    ASSERT_LT(at, all.vertices.size());
    ++at;
  }
  EXPECT_EQ(some.mesh.attributes[0].values.size(), some.mesh.vertices.size());
}

TEST(Pieces, GoAfterTrimmingAndWithAnOffset) {
  Cloud cloud = test::plane_cloud(20'000, 4);
  test::append(cloud, test::sphere_cloud(2'000, 5, 0.2, {0, 0, 0.8}));
  const Outcome trimmed = run(cloud, {{.depth = 7}, {.trim = 0.02, .largest = true}});
  EXPECT_EQ(measure(trimmed.mesh).components, 1);
  EXPECT_NEAR(measure(trimmed.mesh).area, 4.4, 0.4);
  const Outcome offset = run(three_spheres(), {{.depth = 7, .offset = 0.05}, {.largest = true}});
  EXPECT_EQ(measure(offset.mesh).components, 1);
  EXPECT_NEAR(measure(offset.mesh).volume, 4.18879 * 1.05 * 1.05 * 1.05, 0.05);
}

TEST(Pieces, AreTheSameInAnyOrder) {
  const Options options{{.depth = 7}, {.min_component = 0.02}};
  expect_same_bytes(run(three_spheres(), options, 1).mesh, run(test::shuffled(three_spheres(), 6), options, 5).mesh);
}

TEST(Pieces, NothingLeftIsAnError) {
  EXPECT_EQ(error_of([] {
              (void)run(three_spheres(), {{.depth = 5}, {.min_component = 1e6}});
            }),
            ErrorCode::empty_result);
  for (const double bad : {-1.0, 1.5, 1e300 * 1e300})
    EXPECT_EQ(error_of([&] { validate(Options{{}, {.min_component = bad}}); }), ErrorCode::usage) << bad;
}

}  // namespace
}  // namespace pointskin
