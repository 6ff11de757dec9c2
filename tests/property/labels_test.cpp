// Labels and double attributes of clouds on the vertices of reconstructed meshes.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::reconstructed;

constexpr std::int32_t kFirst = 1'999'999'001;  // odd, far beyond the whole numbers of float

/// Every point carries its number.
Cloud numbered(Cloud cloud) {
  std::vector<std::int32_t> ids(cloud.positions.size());
  std::iota(ids.begin(), ids.end(), kFirst);
  cloud.attributes.push_back({"label", std::move(ids)});
  return cloud;
}

double distance(const Vec3f& a, const Vec3f& b) {
  return std::hypot(double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z);
}

/// The label of every vertex is the number of a point that is as near as any that has one, but for rounding.
void expect_nearest(const Mesh& mesh, const Cloud& cloud, std::size_t attribute) {
  const AttributeValues& given = cloud.attributes[attribute].values;
  const AttributeValues& labels = mesh.attributes[attribute].values;
  ASSERT_EQ(labels.type(), AttributeType::int32);
  ASSERT_EQ(labels.size(), mesh.vertices.size());
  ASSERT_FALSE(labels.has_mask());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto chosen = static_cast<std::size_t>(labels.as<std::int32_t>()[v] - kFirst);
    ASSERT_LT(chosen, cloud.positions.size());
    ASSERT_FALSE(given.is_missing(chosen));
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cloud.positions.size(); ++i)
      if (!given.is_missing(i)) best = std::min(best, distance(mesh.vertices[v], cloud.positions[i]));
    ASSERT_LE(distance(mesh.vertices[v], cloud.positions[chosen]), best + 1e-6);
  }
}

TEST(KeptLabels, AreThoseOfTheNearestPoint) {
  const Cloud cloud = numbered(test::torus_cloud(3'000, 1));
  expect_nearest(reconstructed(cloud, {{.depth = 6}, {.attributes = true}}), cloud, 0);
  expect_nearest(reconstructed(cloud, {{.depth = 3}, {.attributes = true}}), cloud, 0);
  expect_nearest(reconstructed(cloud, {{.depth = 5, .field = FieldKind::distance}, {.attributes = true}}), cloud, 0);
}

TEST(KeptLabels, AreThoseOfTheNearestPointThatHasOne) {
  Cloud cloud = numbered(numbered(numbered(test::sphere_cloud(3'000, 2))));
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (cloud.positions[i].z > 0) cloud.attributes[1].values.set_missing(i);  // half of the sphere is far from any
    if (i % 5 != 0) cloud.attributes[2].values.set_missing(i);
  }
  const Mesh mesh = reconstructed(cloud, {{.depth = 6}, {.attributes = true}});
  for (std::size_t a = 0; a < 3; ++a) expect_nearest(mesh, cloud, a);
}

TEST(KeptLabels, GoOnIntoHoles) {
  Cloud cloud = test::sphere_cloud(4'000, 3);
  std::vector<bool> keep;
  for (const Vec3f& p : cloud.positions) keep.push_back(p.z < 0.6F);
  Cloud open;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    open.positions.push_back(cloud.positions[i]);
    open.normals.push_back(cloud.normals[i]);
  }
  open = numbered(std::move(open));
  expect_nearest(reconstructed(open, {{.depth = 6}, {.attributes = true}}), open, 0);
}

TEST(KeptLabels, AreNeverBetweenTwo) {
  Cloud cloud = test::sphere_cloud(20'000, 4);
  const auto half = [](const Vec3f& p) { return p.x < 0 ? 2 : 200; };
  cloud.attributes = {test::attribute_of<std::uint8_t>("class", cloud.positions, half),
                      test::attribute_of<std::uint8_t>("quality", cloud.positions, half),
                      test::attribute_of<std::uint16_t>("intensity", cloud.positions, half),
                      test::attribute_of<std::int16_t>("anything", cloud.positions, half)};
  const Mesh mesh = reconstructed(cloud, {{.depth = 6}, {.attributes = true}});
  const auto between = [&](std::size_t a) {
    std::int64_t count = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double value = mesh.attributes[a].values.at(v);
      count += value != 2 && value != 200 ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(between(0), 0);
  EXPECT_GT(between(1), 50) << "bytes that are no labels are averaged";
  EXPECT_GT(between(2), 50) << "as are intensities";
  EXPECT_EQ(between(3), 0);
  for (std::size_t a = 0; a < 4; ++a) EXPECT_EQ(mesh.attributes[a].type(), cloud.attributes[a].type());
}

TEST(KeptLabels, HaveTheSameBytesForAnyThreadsAndAnyOrderOfThePoints) {
  Cloud cloud = test::linked_tori_cloud(10'000, 5);
  test::append(cloud, Cloud(cloud));  // the same points with other labels
  cloud = numbered(numbered(std::move(cloud)));
  std::vector<double> times(cloud.positions.size());
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = 4e8 + 1e-6 * static_cast<double>(i);
  cloud.attributes.push_back({"gps_time", std::move(times)});
  for (std::size_t i = 0; i < cloud.positions.size(); i += 3) cloud.attributes[1].values.set_missing(i);
  const Options options{{.depth = 7}, {.attributes = true}};
  const Mesh one = reconstructed(cloud, options, 1);
  expect_same_bytes(one, reconstructed(cloud, options, 3));
  for (const std::uint64_t seed : {6, 7})
    expect_same_bytes(one, reconstructed(test::shuffled(cloud, seed), options, 2));
  Mesh bare = one;
  bare.attributes.clear();
  expect_same_bytes(bare, reconstructed(cloud, {{.depth = 7}}));
}

TEST(KeptLabels, StayInTheirPlaceAmongTheOthers) {
  Cloud cloud = test::sphere_cloud(2'000, 8);
  const auto z = [](const Vec3f& p) { return 100 + 50 * p.z; };
  cloud.attributes = {
      test::attribute_of<float>("a", cloud.positions, z), test::attribute_of<std::int32_t>("b", cloud.positions, z),
      test::attribute_of<std::uint8_t>("c", cloud.positions, z),
      test::attribute_of<std::uint32_t>("d", cloud.positions, z), test::attribute_of<double>("e", cloud.positions, z)};
  const Mesh mesh = reconstructed(cloud, {{.depth = 6}, {.density = true, .attributes = true}});
  ASSERT_EQ(mesh.attributes.size(), 6U);
  for (std::size_t a = 0; a < 5; ++a) {
    EXPECT_EQ(mesh.attributes[a].name, cloud.attributes[a].name);
    EXPECT_EQ(mesh.attributes[a].type(), cloud.attributes[a].type());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      ASSERT_NEAR(mesh.attributes[a].values.at(v), z(mesh.vertices[v]), 8) << cloud.attributes[a].name;
  }
}

/// Seconds of GPS with microseconds, as lidar has them, rising along x over 5 milliseconds.
TEST(KeptDoubles, KeepMicrosecondsOfGpsTimes) {
  const auto time = [](const Vec3f& p) { return 4e8 + 2.5e-3 * p.x; };
  Cloud cloud = test::sphere_cloud(50'000, 9);
  cloud.attributes = {test::attribute_of<double>("gps_time", cloud.positions, time)};
  const int depth = 6;
  const Mesh mesh = reconstructed(cloud, {{.depth = depth}, {.attributes = true}});
  const std::vector<double>& times = mesh.attributes[0].values.as<double>();
  const double cell = 2.2 / (1 << depth);
  double squares = 0;
  for (std::size_t v = 0; v < times.size(); ++v) {
    const double error = times[v] - time(mesh.vertices[v]);
    ASSERT_LT(std::abs(error), 1.5 * cell * 2.5e-3);
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(times.size())), 0.25 * cell * 2.5e-3);
  EXPECT_GT(std::set<double>(times.begin(), times.end()).size(), times.size() / 2) << "float has 1 in 32 seconds";
}

TEST(KeptDoubles, ThatAreTheSameEverywhereComeBackExactly) {
  Cloud cloud = test::torus_cloud(3'000, 10);
  cloud.attributes = {{"gps_time", std::vector<double>(3'000, 400000000.000001)}};
  const Mesh mesh = reconstructed(cloud, {{.depth = 7}, {.attributes = true}});
  for (const double v : mesh.attributes[0].values.as<double>()) ASSERT_EQ(v, 400000000.000001);
}

}  // namespace
}  // namespace pointskin
