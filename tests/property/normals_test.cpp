// Normals of clouds without, and of clouds with wrong ones: on the right side for every shape, whatever the start.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/normals.hpp>
#include <pointskin/reconstruct.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::shared_cloud;

double dot(const Vec3f& a, const Vec3f& b) { return double{a.x} * b.x + double{a.y} * b.y + double{a.z} * b.z; }

/// Share of normals on the same side as the true ones.
double right_share(const Cloud& cloud, const Cloud& truth) {
  std::int64_t right = 0;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) right += dot(cloud.normals[i], truth.normals[i]) > 0 ? 1 : 0;
  return static_cast<double>(right) / static_cast<double>(cloud.size());
}

Cloud without_normals(Cloud cloud) {
  cloud.normals.clear();
  return cloud;
}

/// Every normal turned with this chance.
Cloud partly_flipped(Cloud cloud, double share, std::uint64_t seed) {
  test::Random random(seed);
  for (Vec3f& n : cloud.normals)
    if (random.unit() < share) n = {-n.x, -n.y, -n.z};
  return cloud;
}

NormalReport orient(Cloud& cloud, const NormalOptions& options = {}, int threads = 2) {
  NormalEstimator estimator(Device::cpu(threads));
  estimator.orient(cloud, options);
  return estimator.report();
}

/// Spheres in each other: solid, cavity, solid.
Cloud nested_spheres() {
  Cloud cloud = test::sphere_cloud(12'000, 20);
  test::append(cloud, test::flipped(test::sphere_cloud(8'000, 21, 0.8)));
  test::append(cloud, test::sphere_cloud(4'000, 22, 0.4));
  return cloud;
}

Cloud below(const Cloud& cloud, float z) {
  Cloud out;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (cloud.positions[i].z >= z) continue;
    out.positions.push_back(cloud.positions[i]);
    out.normals.push_back(cloud.normals[i]);
  }
  return out;
}

/// A spherical bowl with a wall of 2.2 sample spacings, inside and outside linked at the rim alone.
Cloud thin_bowl() {
  constexpr double kInner = 0.92;
  constexpr float kRim = 0.5F;
  Cloud cloud = below(test::sphere_cloud(9'800, 30), kRim);
  test::append(cloud, below(test::flipped(test::sphere_cloud(8'300, 31, kInner)), kRim));
  test::Random random(32);
  Cloud rim;
  for (int i = 0; i < 380; ++i) {
    const double angle = random.in(0, 2 * 3.14159265358979);
    const double radius = std::sqrt(random.in(kInner * kInner - 0.25, 0.75));
    rim.positions.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), kRim});
    rim.normals.push_back({0, 0, 1});
  }
  test::append(cloud, rim);
  return cloud;
}

struct Named {
  std::string name;
  Cloud cloud;
};
std::vector<Named> shapes() {
  return {{"sphere", test::sphere_cloud(5'000, 1)},
          {"torus", test::torus_cloud(10'000, 2)},
          {"linked tori", test::linked_tori_cloud(20'000, 3)},
          {"box", test::box_cloud(10'000, 4)},
          {"thin plate", test::thin_plate_cloud(20'000, 5, 0.04)},
          {"thinner plate", test::thin_plate_cloud(40'000, 6, 0.02)},
          {"thin bowl", thin_bowl()},
          {"near spheres", test::two_spheres_cloud(20'000, 7, 0.02)},
          {"nested spheres", nested_spheres()},
          {"noisy torus", test::jittered(test::torus_cloud(20'000, 8), 9, 0.03)}};
}

TEST(Normals, OfEveryShapePointOutwards) {
  for (const Named& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    Cloud cloud = without_normals(shape.cloud);
    const NormalReport report = orient(cloud);
    EXPECT_EQ(report.method, NormalMethod::propagate);
    EXPECT_GE(right_share(cloud, shape.cloud), 0.99);
    EXPECT_TRUE(report.settled);
    EXPECT_GT(report.enclosing, 0.1);
    for (const Vec3f& n : cloud.normals) ASSERT_NEAR(dot(n, n), 1, 1e-5);
  }
}

TEST(Normals, FlippedAtRandomAreCorrected) {
  for (const Named& shape : shapes())
    for (const double share : {0.1, 0.3, 0.5}) {
      SCOPED_TRACE(shape.name + ", " + std::to_string(share));
      Cloud cloud = partly_flipped(shape.cloud, share, 10);
      const NormalReport report = orient(cloud);
      EXPECT_EQ(report.method, NormalMethod::repair);
      EXPECT_GE(right_share(cloud, shape.cloud), 0.99);
      EXPECT_EQ(report.kept + report.flipped + report.replaced, cloud.size());
      EXPECT_NEAR(static_cast<double>(report.flipped), share * static_cast<double>(cloud.size()),
                  0.02 * static_cast<double>(cloud.size()));
    }
}

TEST(Normals, FlippedInARegionAreCorrected) {
  for (const Named& shape : shapes()) {
    const bool is_of_several = shape.name.find("spheres") != std::string::npos || shape.name == "linked tori";
    if (is_of_several) continue;  // most of one is flipped: that may be meant
    SCOPED_TRACE(shape.name);
    Cloud cloud = shape.cloud;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      Vec3f& n = cloud.normals[i];
      if (cloud.positions[i].x > 0.3F) n = {-n.x, -n.y, -n.z};
    }
    orient(cloud);
    EXPECT_GE(right_share(cloud, shape.cloud), 0.99);
  }
}

TEST(Normals, ThatAreRightStayRightOnThinSheets) {
  for (const Named& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    Cloud cloud = shape.cloud;
    orient(cloud);
    EXPECT_GE(right_share(cloud, shape.cloud), 0.99);
  }
}

TEST(Normals, TakeNoMoreMemoryThanEstimated) {
  for (const Named& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    Cloud cloud = without_normals(shape.cloud);
    const auto estimate = static_cast<double>(estimate_normals_device_bytes(cloud));
    const auto peak = static_cast<double>(orient(cloud).device_peak_bytes);
    EXPECT_LE(peak, estimate);
    EXPECT_GE(1.7 * peak, estimate);
  }
}

TEST(Normals, ThatAreRightStayByteForByte) {
  const Cloud truth = test::torus_cloud(10'000, 11);
  Cloud cloud = truth;
  const NormalReport report = orient(cloud);
  EXPECT_EQ(report.kept, cloud.size());
  EXPECT_EQ(report.enclosing > 0.3, true);
  EXPECT_TRUE(test::same_bytes(cloud.normals, truth.normals));
  EXPECT_TRUE(test::same_bytes(cloud.positions, truth.positions));
}

TEST(Normals, TurnedInwardsStayWithRepairAlone) {
  const Cloud inward = test::flipped(test::sphere_cloud(5'000, 12));
  Cloud cloud = inward;
  NormalOptions on_purpose;
  on_purpose.method = NormalMethod::repair;
  orient(cloud, on_purpose);
  EXPECT_TRUE(test::same_bytes(cloud.normals, inward.normals));
  NormalOptions anew;
  anew.method = NormalMethod::propagate;
  orient(cloud, anew);
  EXPECT_EQ(right_share(cloud, inward), 0);
}

TEST(Normals, TurnedInwardsAreTurnedAllByDefault) {
  const Cloud truth = test::sphere_cloud(5'000, 12);
  Cloud cloud = test::flipped(truth);
  const NormalReport report = orient(cloud);
  EXPECT_EQ(report.flipped, cloud.size());
  EXPECT_NE(report.assumed.find("pointed into"), std::string::npos) << report.assumed;
  EXPECT_TRUE(test::same_bytes(cloud.normals, truth.normals));
}

TEST(Normals, SettleFromARandomStart) {
  for (const Named& shape :
       {Named{"torus", test::torus_cloud(10'000, 13)}, Named{"linked tori", test::linked_tori_cloud(20'000, 14)}}) {
    SCOPED_TRACE(shape.name);
    NormalOptions options;
    options.method = NormalMethod::iterate;
    options.random_start = true;
    Cloud cloud = without_normals(shape.cloud);
    const NormalReport report = orient(cloud, options);
    EXPECT_GE(right_share(cloud, shape.cloud), 0.995);
    EXPECT_GT(report.rounds, 2);
  }
}

TEST(Normals, PointToTheSensorInsideARoom) {
  const Cloud truth = test::flipped(test::box_cloud(20'000, 15));  // a room seen from inside
  Cloud cloud = without_normals(truth);
  cloud.origin = {10, 20, 30};
  NormalOptions options;
  options.sensors = {{10.2, 19.7, 30.1}};
  const NormalReport report = orient(cloud, options);
  EXPECT_EQ(report.method, NormalMethod::sensor);
  EXPECT_EQ(right_share(cloud, truth), 1);
}

TEST(Normals, FollowTheViewVectorsOfThePoints) {
  const Cloud truth = test::flipped(test::box_cloud(5'000, 16));
  for (const std::vector<std::string>& names : {std::vector<std::string>{"vx", "vy", "vz"},
                                                {"view_x", "view_y", "view_z"},
                                                {"sensor_x", "sensor_y", "sensor_z"}}) {
    Cloud cloud = without_normals(truth);
    constexpr float Vec3f::*kAxes[3] = {&Vec3f::x, &Vec3f::y, &Vec3f::z};
    for (std::size_t a = 0; a < 3; ++a)
      cloud.attributes.push_back(test::attribute_of<float>(
          names[a], cloud.positions, [&](const Vec3f& p) { return names[0][0] == 's' ? 0.1F : 0.1F - p.*kAxes[a]; }));
    EXPECT_TRUE(has_view_attributes(cloud));
    EXPECT_EQ(orient(cloud).method, NormalMethod::sensor);
    EXPECT_EQ(right_share(cloud, truth), 1);
  }
}

TEST(Normals, OfAnOpenSceneSayWhatWasAssumed) {
  Cloud cap;
  const Cloud sphere = test::sphere_cloud(20'000, 17);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    if (sphere.positions[i].z > -0.2F) {
      cap.positions.push_back(sphere.positions[i]);
      cap.normals.push_back(sphere.normals[i]);
    }
  Cloud cloud = without_normals(cap);
  const NormalReport open = orient(cloud);
  EXPECT_EQ(right_share(cloud, cap), 1);
  EXPECT_NE(open.assumed.find("solid"), std::string::npos);
  Cloud plane = without_normals(test::plane_cloud(5'000, 18));
  const NormalReport flat = orient(plane);
  EXPECT_NE(flat.assumed.find("guess"), std::string::npos) << flat.assumed;
  const double side = plane.normals[0].z;
  for (const Vec3f& n : plane.normals) ASSERT_GT(side * n.z, 0.9);  // one side, whichever
}

TEST(Normals, DoNotDependOnThreadsOrOrder) {
  for (const NormalMethod method : {NormalMethod::propagate, NormalMethod::iterate, NormalMethod::repair}) {
    const Cloud cloud = partly_flipped(test::jittered(test::linked_tori_cloud(6'000, 19), 20, 0.01), 0.3, 21);
    NormalOptions options;
    options.method = method;
    options.random_start = true;
    options.curvature = true;
    Cloud one = cloud;
    orient(one, options, 1);
    Cloud three = cloud;
    orient(three, options, 3);
    EXPECT_TRUE(test::same_bytes(one.normals, three.normals));
    Cloud other = test::shuffled(cloud, 22);
    orient(other, options);
    const Cloud expected = test::shuffled(one, 22);
    EXPECT_TRUE(test::same_bytes(other.normals, expected.normals));
    ASSERT_EQ(other.attributes.size(), 2U);
    for (std::size_t a = 0; a < 2; ++a)
      EXPECT_TRUE(test::same_bytes(other.attributes[a].values, expected.attributes[a].values));
  }
}

TEST(Normals, ComeWithConfidenceAndCurvature) {
  Cloud cloud = without_normals(test::sphere_cloud(10'000, 23, 2));
  cloud.attributes.push_back({"height", std::vector<float>(10'000, 1.0F)});
  NormalOptions options;
  options.curvature = true;
  const NormalReport report = orient(cloud, options);
  ASSERT_EQ(cloud.attributes.size(), 3U);
  EXPECT_EQ(cloud.attributes[1].name, "confidence");
  EXPECT_EQ(cloud.attributes[2].name, "curvature");
  double sum = 0;
  for (const float c : cloud.attributes[1].values.as<float>()) {
    ASSERT_GE(c, 0);
    ASSERT_LE(c, 1);
  }
  for (const float c : cloud.attributes[2].values.as<float>()) sum += c;
  EXPECT_NEAR(sum / 10'000, 0.5, 0.02);
  EXPECT_EQ(report.doubtful, 0);
}

TEST(Normals, RefuseWhatCannotBe) {
  Cloud none;
  EXPECT_EQ(error_of([&] { orient(none); }), ErrorCode::empty_result);
  Cloud one_place;
  one_place.positions.assign(100, Vec3f{1, 1, 1});
  EXPECT_EQ(error_of([&] { orient(one_place); }), ErrorCode::empty_result);
  Cloud bad = without_normals(test::sphere_cloud(100, 24));
  bad.positions[5].y = NAN;
  EXPECT_EQ(error_of([&] { orient(bad); }), ErrorCode::invalid_input);
  Cloud sphere = without_normals(test::sphere_cloud(100, 25));
  EXPECT_EQ(error_of([&] { orient(sphere, {.method = NormalMethod::sensor}); }), ErrorCode::usage);
  EXPECT_EQ(error_of([&] { orient(sphere, {.method = NormalMethod::repair}); }), ErrorCode::no_normals);
  EXPECT_EQ(error_of([&] { orient(sphere, {.max_rounds = 0}); }), ErrorCode::usage);
  EXPECT_EQ(error_of([&] { orient(sphere, {.keep_within_degrees = 91}); }), ErrorCode::usage);
  EXPECT_EQ(error_of([&] { orient(sphere, {.progress = [](const Progress&) { return false; }}); }),
            ErrorCode::interrupted);
  EXPECT_TRUE(sphere.normals.empty());
}

TEST(Normals, OfTinyAndDegenerateCloudsExist) {
  for (const int n : {3, 4, 10, 17, 40}) {
    Cloud cloud = without_normals(test::sphere_cloud(n, 26));
    orient(cloud);
    ASSERT_EQ(cloud.normals.size(), static_cast<std::size_t>(n));
    for (const Vec3f& normal : cloud.normals) EXPECT_NEAR(dot(normal, normal), 1, 1e-4);
  }
  Cloud line;
  for (int i = 0; i < 100; ++i) line.positions.push_back({static_cast<float>(i), 0, 0});
  orient(line);
  for (const Vec3f& normal : line.normals) EXPECT_NEAR(dot(normal, normal), 1, 1e-4);
}

TEST(Normals, OneRoundIsEnoughToStop) {
  Cloud cloud = without_normals(test::two_spheres_cloud(10'000, 27, 0.5));
  NormalOptions options;
  options.max_rounds = 1;
  const NormalReport report = orient(cloud, options);
  EXPECT_LE(report.rounds, 1);
  EXPECT_FALSE(report.settled);
  EXPECT_TRUE(cloud.has_normals());
}

TEST(Normals, OfScansAreOnTheRightSide) {
  int tested = 0;
  for (const char* name : {"armadillo_oriented", "srb_anchor", "srb_dc", "cgal_kitten"}) {
    const std::optional<Cloud> truth = shared_cloud(name);
    if (!truth) continue;
    ++tested;
    SCOPED_TRACE(name);
    Cloud cloud = without_normals(*truth);
    orient(cloud);
    EXPECT_GE(right_share(cloud, *truth), 0.995);
    Cloud wrong = partly_flipped(*truth, 0.3, 28);
    orient(wrong);
    EXPECT_GE(right_share(wrong, *truth), 0.99);
  }
  if (tested == 0) GTEST_SKIP() << "the scans of ../shared/data are not here";
}

TEST(Normals, OfTheArmadilloGiveTheSameMesh) {
  const std::optional<Cloud> truth = shared_cloud("armadillo_oriented");
  if (!truth) GTEST_SKIP() << "the scans of ../shared/data are not here";
  Cloud cloud = without_normals(*truth);
  orient(cloud);
  const MeshReport report = measure(test::reconstructed(cloud, {{.depth = 8}}));
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
}

}  // namespace
}  // namespace pointskin
