// Memory: the estimate against the measured peak, and the limit that it is checked against.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;

std::int64_t peak_of(const Cloud& cloud, const Options& options) {
  Reconstructor r(Device::cpu(2));
  (void)r.reconstruct(cloud, options);
  return r.report().device_peak_bytes;
}

void expect_good_estimate(const Cloud& cloud, const Options& options, const std::string& what) {
  SCOPED_TRACE(what + ", " + std::to_string(cloud.size()) + " points, depth " + std::to_string(options.depth));
  const auto estimate = static_cast<double>(estimate_device_bytes(cloud, options, 2));
  const auto peak = static_cast<double>(peak_of(cloud, options));
  EXPECT_GT(estimate, 0.85 * peak);
  EXPECT_LT(estimate, 1.15 * peak);
}

Cloud one_place(std::int64_t n) {
  Cloud cloud;
  cloud.positions.assign(static_cast<std::size_t>(n), {1, 2, 3});
  cloud.normals.assign(static_cast<std::size_t>(n), {0, 0, 1});
  return cloud;
}

/// Points in a ball, their normals pointing away from its centre: every cell of the volume is occupied.
Cloud ball_cloud(std::int64_t n, std::uint64_t seed) {
  test::Random random(seed);
  Cloud cloud = test::sphere_cloud(n, seed);
  for (Vec3f& p : cloud.positions) {
    const auto r = static_cast<float>(random.unit());
    p = {r * p.x, r * p.y, r * p.z};
  }
  return cloud;
}

Cloud line_cloud(std::int64_t n, std::uint64_t seed) {
  test::Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const auto t = static_cast<float>(random.unit());
    cloud.positions.push_back({t, 2 * t, 3 * t});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

/// Two small spheres, a thousand radii apart.
Cloud two_clusters(std::int64_t n, std::uint64_t seed) {
  Cloud cloud = test::sphere_cloud(n / 2, seed);
  test::append(cloud, test::sphere_cloud(n - n / 2, seed + 1, 1, {1000, 300, -700}));
  return cloud;
}

Cloud with_outliers(Cloud cloud, int count, float distance) {
  for (int i = 0; i < count; ++i) {
    const auto t = static_cast<float>(i + 1);
    cloud.positions.push_back({distance * t, -distance, distance / t});
    cloud.normals.push_back({1, 0, 0});
  }
  return cloud;
}

TEST(MemoryEstimate, IsWithin15PercentOfThePeakForSurfaces) {
  for (const std::int64_t n : {2'000, 60'000})
    for (const int depth : {3, 5, 6, 7, 8}) {
      expect_good_estimate(test::sphere_cloud(n, 1), {{.depth = depth}}, "sphere");
      expect_good_estimate(test::torus_cloud(n, 2), {{.depth = depth}}, "torus");
      expect_good_estimate(test::box_cloud(n, 3), {{.depth = depth}}, "box");
      // Judged, so thin a plate is looked at twice, which takes more than its surface.
      expect_good_estimate(test::thin_plate_cloud(n, 4, 0.05), {{.depth = depth, .point_normals = PointNormals::given}},
                           "plate");
      expect_good_estimate(test::linked_tori_cloud(n, 5), {{.depth = depth}}, "tori");
      expect_good_estimate(test::plane_cloud(n, 6), {{.depth = depth}}, "plane");
    }
}

TEST(MemoryEstimate, IsWithin15PercentOfThePeakForDenseAndForDeepClouds) {
  expect_good_estimate(test::sphere_cloud(500'000, 7), {{.depth = 5}}, "sphere");
  expect_good_estimate(test::sphere_cloud(500'000, 8), {{.depth = 8}}, "sphere");
  expect_good_estimate(test::torus_cloud(100'000, 9), {{.depth = 9}}, "torus");
  expect_good_estimate(test::sphere_cloud(300, 10), {{.depth = 13}}, "sphere");
}

TEST(MemoryEstimate, IsWithin15PercentOfThePeakForUnusualClouds) {
  for (const int depth : {4, 7, 9}) {
    expect_good_estimate(two_clusters(20'000, 11), {{.depth = depth}}, "two clusters");
    expect_good_estimate(with_outliers(test::sphere_cloud(20'000, 12), 5, 300), {{.depth = depth}}, "outliers");
    expect_good_estimate(test::sphere_cloud(9, 13), {{.depth = depth}}, "nine points");
  }
  for (const int depth : {4, 6, 7}) expect_good_estimate(ball_cloud(50'000, 14), {{.depth = depth}}, "ball");
}

TEST(MemoryEstimate, FollowsTheOptions) {
  const Cloud cloud = test::torus_cloud(40'000, 15);
  expect_good_estimate(cloud, {{.depth = 8, .screening = 0}}, "no screening");
  expect_good_estimate(cloud, {{.depth = 8, .scale = 3}}, "scale");
  expect_good_estimate(cloud, {{.depth = 8}, {.normals = false, .density = true}}, "density, no normals");
}

TEST(MemoryEstimate, CountsHeldCorners) {
  const Cloud cloud = test::torus_cloud(40'000, 16);
  const auto envelope = std::make_shared<const Mesh>(test::icosphere_mesh(4, 1.5));
  for (const int depth : {6, 8}) {
    expect_good_estimate(cloud, {{.depth = depth, .boundary = Boundary::dirichlet}}, "Dirichlet");
    expect_good_estimate(cloud, {{.depth = depth, .envelope = envelope}}, "envelope");
  }
}

TEST(MemoryEstimate, IsWithin15PercentWhenTrimming) {
  for (const int depth : {5, 7, 8}) {
    expect_good_estimate(test::plane_cloud(60'000, 20), {{.depth = depth}, {.trim = 0.05}}, "plane");
    expect_good_estimate(test::torus_cloud(60'000, 21), {{.depth = depth}, {.trim = 0.01}}, "torus");
    expect_good_estimate(test::plane_cloud(500'000, 22), {{.depth = depth}, {.normals = false, .trim = 0.05}}, "plane");
  }
}

Cloud with_attributes(Cloud cloud, int count) {
  for (int i = 0; i < count; ++i)
    cloud.attributes.push_back({std::string(1, static_cast<char>('a' + i)),
                                std::vector<float>(static_cast<std::size_t>(cloud.size()), static_cast<float>(i))});
  return cloud;
}

TEST(MemoryEstimate, CountsTheAttributesThatAreKept) {
  for (const int count : {1, 3, 20})
    for (const int depth : {5, 8}) {
      const Cloud cloud = with_attributes(test::torus_cloud(60'000, 20), count);
      expect_good_estimate(cloud, {{.depth = depth, .confidence = true}, {.attributes = true}}, "attributes");
      expect_good_estimate(cloud, {{.depth = depth}}, "attributes that are not kept");
    }
  const Cloud sparse = with_attributes(test::sphere_cloud(300, 21), 3);
  expect_good_estimate(sparse, {{.depth = 11}, {.attributes = true}}, "attributes of few points");
  const Cloud dense = with_attributes(test::sphere_cloud(300'000, 22), 3);
  expect_good_estimate(dense, {{.depth = 5}, {.attributes = true}}, "attributes of many points");
}

/// `count` attributes of a type and name, the first two thirds of whose values are there.
Cloud with_types(Cloud cloud, const std::string& name, AttributeType type, int count, bool gaps) {
  AttributeValues values(type, cloud.positions.size());
  for (std::size_t i = 0; gaps && i < cloud.positions.size(); i += 3) values.set_missing(i);
  for (int i = 0; i < count; ++i) cloud.attributes.push_back({name + std::to_string(i), values});
  return cloud;
}

TEST(MemoryEstimate, CountsAttributesInTheirTypes) {
  const Cloud torus = test::torus_cloud(60'000, 23);
  const Cloud dense = test::sphere_cloud(300'000, 24);
  const Cloud sparse = test::sphere_cloud(300, 25);
  for (const bool gaps : {false, true})
    for (const int count : {1, 12}) {
      const auto check = [&](const std::string& name, AttributeType type) {
        const std::string what = name + (gaps ? " with gaps, " : ", ") + std::to_string(count);
        expect_good_estimate(with_types(torus, name, type, count, gaps), {{.depth = 7}, {.attributes = true}}, what);
        expect_good_estimate(with_types(dense, name, type, count, gaps), {{.depth = 5}, {.attributes = true}}, what);
        expect_good_estimate(with_types(sparse, name, type, count, gaps), {{.depth = 10}, {.attributes = true}}, what);
      };
      check("byte", AttributeType::uint8);
      check("time", AttributeType::float64);
      check("label", AttributeType::uint8);
      check("label", AttributeType::int32);
      check("label", AttributeType::uint64);
    }
}

TEST(MemoryEstimate, OfColoursIsLessThanOfFloats) {
  const Cloud cloud = test::sphere_cloud(300'000, 26);
  const Options options{{.depth = 5}, {.attributes = true}};
  const std::int64_t floats = peak_of(with_types(cloud, "red", AttributeType::float32, 3, false), options);
  const std::int64_t bytes = peak_of(with_types(cloud, "red", AttributeType::uint8, 3, false), options);
  EXPECT_LE(bytes, floats - 9 * cloud.size()) << "three bytes a colour instead of twelve";
}

TEST(MemoryEstimate, IsWithin15PercentWherePointsShareTheirPlaces) {
  const Cloud once = test::sphere_cloud(100'000, 16);
  Cloud cloud = once;
  test::append(cloud, once);
  expect_good_estimate(cloud, {{.depth = 5}}, "sphere, twice");
}

TEST(MemoryEstimate, DoesNotDependOnTheThreads) {
  const Cloud cloud = test::box_cloud(30'000, 17);
  EXPECT_EQ(estimate_device_bytes(cloud, {{.depth = 8}}, 1), estimate_device_bytes(cloud, {{.depth = 8}}, 3));
}

TEST(MemoryEstimate, OfCloudsWithoutASurfaceIsSmall) {
  constexpr std::int64_t kMegabyte = 1'000'000;
  EXPECT_EQ(estimate_device_bytes(Cloud(), {}), 0);
  EXPECT_LT(estimate_device_bytes(one_place(1), {{.depth = 20}}), kMegabyte);
  EXPECT_LT(estimate_device_bytes(one_place(10'000), {{.depth = 20}}), kMegabyte);
  EXPECT_LT(estimate_device_bytes(line_cloud(1'000, 18), {{.depth = 6}}), 50 * kMegabyte);
  EXPECT_EQ(error_of([] { (void)estimate_device_bytes(one_place(2), {{.depth = 21}}); }), ErrorCode::usage);
}

TEST(MaxMemory, OfTheEstimateIsEnough) {
  const std::vector<Cloud> clouds = {test::sphere_cloud(40'000, 20), test::torus_cloud(60'000, 21),
                                     test::box_cloud(10'000, 22), test::linked_tori_cloud(5'000, 23)};
  for (const Cloud& cloud : clouds)
    for (const int depth : {3, 5, 7, 8}) {
      Options options{{.depth = depth}};
      options.max_memory_bytes = estimate_device_bytes(cloud, options);
      EXPECT_EQ(error_of([&] { (void)test::reconstructed(cloud, options); }), std::nullopt)
          << cloud.size() << " points, depth " << depth;
    }
}

TEST(MaxMemory, RefusesOneByteBelowTheEstimateAndRunsAtIt) {
  const Cloud cloud = test::sphere_cloud(5'000, 19);
  Options options{{.depth = 6}};
  options.max_memory_bytes = estimate_device_bytes(cloud, options);
  EXPECT_EQ(error_of([&] { (void)test::reconstructed(cloud, options); }), std::nullopt);
  --options.max_memory_bytes;
  EXPECT_EQ(error_of([&] { (void)test::reconstructed(cloud, options); }), ErrorCode::over_limit);
  Reconstructor r(Device::cpu(1));
  const UploadedCloud points = upload(r.workspace(), cloud);
  EXPECT_EQ(error_of([&] { (void)r.reconstruct(points, options); }), ErrorCode::over_limit);
}

}  // namespace
}  // namespace pointskin
