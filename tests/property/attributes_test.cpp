// Attributes of clouds on the vertices of reconstructed meshes.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::reconstructed;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

using Function = std::function<double(const Vec3f&)>;

Attribute attribute(const Cloud& cloud, const std::string& name, const Function& f,
                    AttributeType type = AttributeType::float32) {
  const Attribute wide = test::attribute_of<double>(name, cloud.positions, f);
  return {name, wide.values.converted(type)};
}

/// A colour, as bytes, and a scalar.
Cloud coloured(Cloud cloud, std::uint64_t seed) {
  test::Random random(seed);
  const auto byte = [&random](const Vec3f&) { return static_cast<double>(random.below(256)); };
  for (const char* name : {"red", "green", "blue"})
    cloud.attributes.push_back(attribute(cloud, name, byte, AttributeType::uint8));
  cloud.attributes.push_back(attribute(cloud, "height", [](const Vec3f& p) { return p.z; }));
  return cloud;
}

std::vector<std::string> names_of(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Attribute& a : mesh.attributes) names.push_back(a.name);
  return names;
}

/// Largest difference of an attribute along an edge over the edge's length, of edges not shorter than `shortest`.
double steepest(const Mesh& mesh, const Attribute& attribute, double shortest) {
  double worst = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(t[k]);
      const auto b = static_cast<std::size_t>(t[(k + 1) % 3]);
      const Vec3f& p = mesh.vertices[a];
      const Vec3f& q = mesh.vertices[b];
      const double length = std::max(shortest, double{std::hypot(p.x - q.x, p.y - q.y, p.z - q.z)});
      worst = std::max(worst, std::abs(attribute.values.at(a) - attribute.values.at(b)) / length);
    }
  return worst;
}

TEST(KeptAttributes, AreLeftOutUnlessAskedFor) {
  const Cloud plain = test::sphere_cloud(5'000, 1);
  expect_same_bytes(reconstructed(plain, {{.depth = 6}}), reconstructed(coloured(plain, 2), {{.depth = 6}}));
}

TEST(KeptAttributes, ComeByNameAndTypeAndLeaveTheSurfaceAsItIs) {
  Cloud cloud = coloured(test::torus_cloud(20'000, 3), 4);
  test::append(cloud, Cloud(cloud));  // repeated points, in whose order attributes have a say
  std::vector<std::int64_t> twice(40'000);
  std::iota(twice.begin(), twice.begin() + 20'000, 0);
  std::iota(twice.rbegin(), twice.rbegin() + 20'000, 0);
  for (Attribute& a : cloud.attributes) a.values = a.values.gather(twice);
  Mesh mesh = reconstructed(cloud, {{.depth = 7}, {.attributes = true}});
  ASSERT_EQ(names_of(mesh), (std::vector<std::string>{"red", "green", "blue", "height"}));
  for (std::size_t a = 0; a < 4; ++a) {
    EXPECT_EQ(mesh.attributes[a].type(), cloud.attributes[a].type());
    EXPECT_EQ(mesh.attributes[a].values.size(), mesh.vertices.size());
  }
  mesh.attributes.clear();
  expect_same_bytes(mesh, reconstructed(cloud, {{.depth = 7}}));
}

TEST(KeptAttributes, ThatAreTheSameEverywhereComeBackExactly) {
  Cloud cloud = test::torus_cloud(3'000, 5);
  cloud.attributes = {attribute(
                          cloud, "byte", [](const Vec3f&) { return 77; }, AttributeType::uint8),
                      attribute(cloud, "scalar", [](const Vec3f&) { return 0.1; })};
  const Mesh mesh = reconstructed(cloud, {{.depth = 8}, {.attributes = true}});
  for (const std::uint8_t v : mesh.attributes[0].values.as<std::uint8_t>()) ASSERT_EQ(v, 77);
  for (const float v : mesh.attributes[1].values.as<float>()) ASSERT_EQ(v, 0.1F);
}

/// Every sample within a hat is at most a cell away along each axis; the level above has an eighth of its weight.
TEST(KeptAttributes, FollowALinearFunctionToAboutACell) {
  const Function f = [](const Vec3f& p) { return 3 * p.x - 2 * p.y + p.z; };
  Cloud cloud = test::sphere_cloud(200'000, 6);
  cloud.attributes = {attribute(cloud, "f", f)};
  for (int depth = 5; depth <= 7; ++depth) {
    const Mesh mesh = reconstructed(cloud, {{.depth = depth}, {.attributes = true}});
    const double cell = 2.2 / (1 << depth);
    double squares = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const double error = mesh.attributes[0].values.at(i) - f(mesh.vertices[i]);
      squares += error * error;
      ASSERT_LT(std::abs(error), 1.5 * cell * std::sqrt(14)) << "depth " << depth;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(mesh.vertices.size())), 0.25 * cell * std::sqrt(14)) << depth;
  }
}

TEST(KeptAttributes, StayInTheRangeOfTheInput) {
  test::Random random(7);
  Cloud cloud = test::thin_plate_cloud(20'000, 8, 0.1);
  cloud.attributes = {attribute(cloud, "noise", [&random](const Vec3f&) { return random.in(-3, 5); })};
  const std::vector<float>& input = cloud.attributes[0].values.as<float>();
  const auto [low, high] = std::minmax_element(input.begin(), input.end());
  const Mesh mesh = reconstructed(cloud, {{.depth = 7}, {.attributes = true}});
  for (const float v : mesh.attributes[0].values.as<float>()) ASSERT_TRUE(v >= *low && v <= *high) << v;
}

TEST(KeptAttributes, HaveTheSameBytesForAnyThreadsAndAnyOrderOfThePoints) {
  Cloud cloud = test::linked_tori_cloud(20'000, 9);
  test::append(cloud, Cloud(cloud));  // the same points in other colours
  cloud = coloured(cloud, 10);
  for (std::size_t i = 0; i < cloud.positions.size(); i += 3) cloud.attributes[3].values.set_missing(i);
  for (const bool confidence : {false, true}) {
    const Options options{{.depth = 7, .confidence = confidence}, {.attributes = true}};
    const Mesh one = reconstructed(cloud, options, 1);
    expect_same_bytes(one, reconstructed(cloud, options, 3));
    for (const std::uint64_t seed : {11, 12})
      expect_same_bytes(one, reconstructed(test::shuffled(cloud, seed), options, 2));
  }
}

TEST(KeptAttributes, AreThoseOfThePointsThatHaveThem) {  // missing values change nothing but their points' own part
  Cloud cloud = test::sphere_cloud(20'000, 13);
  cloud.attributes = {attribute(cloud, "x", [](const Vec3f& p) { return p.x; })};
  test::Random random(14);
  for (float& v : cloud.attributes[0].values.edit<float>())
    if (random.below(2) == 0) v = random.below(2) == 0 ? kNan : std::numeric_limits<float>::infinity();
  const Mesh mesh = reconstructed(cloud, {{.depth = 6}, {.attributes = true}});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_NEAR(mesh.attributes[0].values.at(i), mesh.vertices[i].x, 2 * 2.2 / 64);
}

TEST(KeptAttributes, ThatNoPointUsedHasAreLeftOutAndNamed) {
  Cloud cloud = test::sphere_cloud(5'000, 18);
  cloud.positions.push_back({100, 0, 0});  // a stray
  cloud.normals.push_back({1, 0, 0});
  const std::size_t n = cloud.positions.size();
  const auto height = attribute(cloud, "height", [](const Vec3f& p) { return p.z; });
  const auto classes = attribute(
      cloud, "class", [](const Vec3f&) { return 3; }, AttributeType::int32);
  AttributeValues of_stray = AttributeValues::missing(AttributeType::uint8, n - 1);
  of_stray.append(std::vector<std::uint8_t>{7});
  const AttributeValues infinite(std::vector<double>(n, std::numeric_limits<double>::infinity()));
  cloud.attributes = {height, classes};
  const Options options{{.depth = 6}, {.attributes = true}};
  const test::Outcome with_both = test::run(cloud, options);
  cloud.attributes = {{"infinite", infinite},
                      height,
                      {"label", AttributeValues::missing(AttributeType::int32, n)},
                      classes,
                      {"heat", AttributeValues::missing(AttributeType::uint8, n)},
                      {"of_stray", of_stray}};
  const test::Outcome with_all = test::run(cloud, options);
  EXPECT_EQ(names_of(with_all.mesh), (std::vector<std::string>{"height", "class"}));
  expect_same_bytes(with_both.mesh, with_all.mesh);
  const auto named = [](const test::Outcome& outcome) {
    std::string all;
    for (const Warning& warning : outcome.report.warnings)
      if (warning.kind == WarningKind::attributes_missing) all += warning.text;
    return all;
  };
  EXPECT_EQ(named(with_both), "");
  EXPECT_EQ(named(with_all),
            "no point that is used has a value of infinite, label, heat, of_stray: the mesh is without them");
}

/// Points of a sphere without a cap, in two halves of different value: the step is a cell wide where there are points,
/// and as wide as the hole is in its middle.
TEST(KeptAttributes, GoOnSmoothlyIntoHoles) {
  const double hole = 0.75;  // z of the cap's border
  Cloud full = test::sphere_cloud(60'000, 15);
  Cloud cloud;
  for (std::size_t i = 0; i < full.positions.size(); ++i) {
    if (full.positions[i].z > hole) continue;
    cloud.positions.push_back(full.positions[i]);
    cloud.normals.push_back(full.normals[i]);
  }
  cloud.attributes = {attribute(cloud, "smooth", [](const Vec3f& p) { return p.x; }),
                      attribute(cloud, "step", [](const Vec3f& p) { return p.x < 0 ? 0 : 1; })};
  const int depth = 7;
  const double cell = 2.2 / (1 << depth);
  const Mesh mesh = reconstructed(cloud, {{.depth = depth}, {.attributes = true}});
  EXPECT_LT(steepest(mesh, mesh.attributes[0], cell / 4), 4);  // the function itself rises by 1 per unit
  const double radius = std::sqrt(1 - hole * hole);
  Mesh cap = mesh;
  std::erase_if(cap.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](std::int32_t v) {
      const Vec3f& p = mesh.vertices[static_cast<std::size_t>(v)];
      return p.z < 0.5 || std::hypot(p.x, p.y) > radius / 2;
    });
  });
  ASSERT_GT(cap.triangles.size(), 10U);
  EXPECT_LT(steepest(cap, mesh.attributes[1], cell / 4), 4 / radius);
  EXPECT_LT(steepest(mesh, mesh.attributes[1], cell / 4), 3 / cell);
}

TEST(KeptAttributes, OfDoubtfulPointsCountLessWithConfidence) {
  Cloud cloud = test::sphere_cloud(20'000, 16);
  test::append(cloud, test::sphere_cloud(20'000, 17));
  std::vector<float> value(40'000, 0.0F);
  for (std::size_t i = 20'000; i < 40'000; ++i) {
    value[i] = 1;
    Vec3f& n = cloud.normals[i];
    n = {n.x / 100, n.y / 100, n.z / 100};
  }
  cloud.attributes = {{"value", std::move(value)}};
  const auto mean_with = [&](bool confidence) {
    const Mesh mesh = reconstructed(cloud, {{.depth = 6, .confidence = confidence}, {.attributes = true}});
    double sum = 0;
    for (const float v : mesh.attributes[0].values.as<float>()) sum += v;
    return sum / static_cast<double>(mesh.vertices.size());
  };
  EXPECT_NEAR(mean_with(false), 0.5, 0.02);
  EXPECT_NEAR(mean_with(true), 1.0 / 101, 0.005);
}

TEST(KeptAttributes, WithNamesOfTheMeshGetAnother) {
  Cloud cloud = test::sphere_cloud(2'000, 18);
  const Function f = [](const Vec3f& p) { return p.x; };
  for (const char* name : {"density", "nx", "red", "red", "input_red"})
    cloud.attributes.push_back(attribute(cloud, name, f));
  EXPECT_EQ(names_of(reconstructed(cloud, {{.depth = 5}, {.attributes = true}})),
            (std::vector<std::string>{"density", "input_nx", "red", "input_red", "input_input_red"}));
  EXPECT_EQ(names_of(reconstructed(cloud, {{.depth = 5}, {.density = true, .attributes = true}})),
            (std::vector<std::string>{"input_density", "input_nx", "red", "input_red", "input_input_red", "density"}));
}

TEST(KeptAttributes, MustHaveTheLengthOfTheCloud) {
  Cloud cloud = test::sphere_cloud(1'000, 19);
  cloud.attributes = {{"short", std::vector<float>(999, 1.0F)}};
  EXPECT_EQ(test::error_of([&] {
              (void)reconstructed(cloud, {{.depth = 4}, {.attributes = true}});
            }),
            ErrorCode::invalid_input);
  EXPECT_EQ(test::error_of([&] { (void)reconstructed(cloud, {{.depth = 4}}); }), std::nullopt);
}

TEST(KeptAttributes, AreThereInEveryExtraction) {
  const Cloud cloud = coloured(test::sphere_cloud(5'000, 20), 21);
  const Options options{{.depth = 6}, {.density = true, .attributes = true}};
  Reconstructor r(Device::cpu(2));
  const Mesh expected = r.reconstruct(cloud, options);
  const Field field = r.solve(cloud, {.depth = 6});
  expect_same_bytes(field.extract(options), expected);
  expect_same_bytes(field.extract(options), expected);
  EXPECT_TRUE(field.extract().attributes.empty());
  expect_same_bytes(r.reconstruct(cloud, options), expected);
}

/// Density counts samples per area wherever they lie, so a half that is sampled four times as densely says so.
TEST(Density, FollowsTheSamplingOfEveryPart) {
  Cloud cloud;
  test::Random random(22);
  const Cloud full = test::sphere_cloud(80'000, 23);
  for (std::size_t i = 0; i < full.positions.size(); ++i) {
    if (full.positions[i].z < 0 && random.below(4) != 0) continue;
    cloud.positions.push_back(full.positions[i]);
    cloud.normals.push_back(full.normals[i]);
  }
  const Mesh mesh = reconstructed(cloud, {{.depth = 7}, {.density = true}});
  const double upper = 80'000 / (4 * std::numbers::pi);
  std::array<double, 2> sum{};
  std::array<double, 2> count{};
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (std::abs(mesh.vertices[i].z) < 0.1) continue;
    const std::size_t half = mesh.vertices[i].z > 0 ? 1 : 0;
    sum[half] += mesh.attributes[0].values.at(i);
    ++count[half];
  }
  EXPECT_NEAR(sum[1] / count[1], upper, 0.2 * upper);
  EXPECT_NEAR(sum[0] / count[0], upper / 4, 0.2 * upper / 4);
}

}  // namespace
}  // namespace pointskin
