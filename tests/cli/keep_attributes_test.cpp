// Colours and other properties of the points on the mesh: --keep-attributes, --colors, merged inputs, formats.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

/// A sphere; below the equator red, above it blue, where green counts up as bytes do; `height` is z.
Cloud painted_sphere(int count, const Vec3f& centre = {}) {
  Cloud cloud;
  std::vector<std::uint8_t> red, green, blue;
  std::vector<float> height;
  for (const Sample& s : sphere(count, centre)) {
    cloud.positions.push_back(s.position);
    cloud.normals.push_back(s.normal);
    red.push_back(s.normal.z < 0 ? 255 : 0);
    green.push_back(static_cast<std::uint8_t>(cloud.positions.size() % 256));
    blue.push_back(s.normal.z < 0 ? 0 : 255);
    height.push_back(s.position.z);
  }
  cloud.attributes = {{"red", red}, {"green", green}, {"blue", blue}, {"height", height}};
  return cloud;
}

std::vector<std::string> names_of(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Attribute& a : mesh.attributes) names.push_back(a.name);
  return names;
}

const Attribute& named(const Mesh& mesh, const std::string& name) {
  return *std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                       [&](const Attribute& a) { return a.name == name; });
}

class KeepAttributes : public testing::Test {
 protected:
  KeepAttributes() { write_cloud(input_, painted_sphere(5000)); }

  Result reconstruct(const Args& more, const Args& inputs = {}) {
    Args args = {"reconstruct"};
    args.insert(args.end(), inputs.begin(), inputs.end());
    if (inputs.empty()) args.push_back(input_);
    args.insert(args.end(), {"-o", output_, "--depth", "6", "-q"});
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  Mesh mesh_with(const Args& more, const Args& inputs = {}) {
    const Result result = reconstruct(more, inputs);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return read_mesh(output_);
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "painted.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(KeepAttributes, WritesThemUnderTheirNamesAndTypes) {
  const Mesh mesh = mesh_with({"--keep-attributes"});
  EXPECT_EQ(names_of(mesh), (std::vector<std::string>{"red", "green", "blue", "height"}));
  const std::string header = read_file(output_).substr(0, 500);
  EXPECT_NE(header.find("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float height\n"),
            std::string::npos)
      << header;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const float z = mesh.vertices[i].z;
    ASSERT_NEAR(named(mesh, "height").values.at(i), z, 0.1);
    const double red = named(mesh, "red").values.at(i);
    ASSERT_TRUE(z > -0.15 || red > 240) << red << " at height " << z;
    ASSERT_TRUE(z < 0.15 || red < 15) << red << " at height " << z;
  }
}

TEST_F(KeepAttributes, IsOffByDefault) {
  EXPECT_TRUE(mesh_with({}).attributes.empty());
  const Mesh kept = mesh_with({"--keep-attributes"});
  EXPECT_EQ(mesh_with({}).vertices, kept.vertices);
}

TEST_F(KeepAttributes, ColorsKeepsColoursAlone) {
  EXPECT_EQ(names_of(mesh_with({"--colors"})), (std::vector<std::string>{"red", "green", "blue"}));
  EXPECT_EQ(names_of(mesh_with({"--colors", "--keep-attributes"})).size(), 4U);
}

TEST_F(KeepAttributes, ColorsWarnsWhereThereAreNone) {
  write_file(input_, ply_bytes(sphere(3000)));
  const Result result = reconstruct({"--colors"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("warning: --colors"), std::string::npos) << result.err;
  const Result all = reconstruct({"--keep-attributes"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_NE(all.err.find("warning: --keep-attributes"), std::string::npos) << all.err;
  EXPECT_TRUE(read_mesh(output_).attributes.empty());
}

TEST_F(KeepAttributes, OfOneInputAreThoseOfItsPoints) {  // two spheres apart, one of them without colours
  const std::string bare = folder_ / "bare.ply";
  write_file(bare, ply_bytes(sphere(5000, {4, 0, 0})));
  for (const Args& inputs : {Args{input_, bare}, Args{bare, input_}}) {
    const Mesh mesh = mesh_with({"--keep-attributes"}, inputs);
    ASSERT_EQ(names_of(mesh), (std::vector<std::string>{"red", "green", "blue", "height"}));
    EXPECT_EQ(mesh.attributes[0].type(), AttributeType::uint8);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Vec3f& p = mesh.vertices[i];
      ASSERT_TRUE(p.x > 1.1 || p.z > -0.15 || mesh.attributes[0].values.at(i) > 240);
    }
  }
}

TEST_F(KeepAttributes, OfADroppedPointGoWithIt) {  // the others keep theirs
  Cloud cloud = painted_sphere(5000);
  for (std::size_t i = 0; i < cloud.normals.size(); i += 7) cloud.normals[i] = {};
  write_cloud(input_, cloud);
  const Result result = reconstruct({"--keep-attributes"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Mesh mesh = read_mesh(output_);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_NEAR(named(mesh, "height").values.at(i), mesh.vertices[i].z, 0.1);
}

TEST_F(KeepAttributes, NamedDensityMakesRoomForTheMeshsOwn) {
  Cloud cloud = painted_sphere(3000);
  cloud.attributes = {{"density", std::vector<float>(3000, 5.0F)}};
  write_cloud(input_, cloud);
  EXPECT_EQ(names_of(mesh_with({"--keep-attributes"})), (std::vector<std::string>{"density"}));
  const Mesh both = mesh_with({"--keep-attributes", "--density"});
  EXPECT_EQ(names_of(both), (std::vector<std::string>{"input_density", "density"}));
  EXPECT_EQ(both.attributes[0].values.as<float>(), std::vector<float>(both.vertices.size(), 5.0F));
}

TEST_F(KeepAttributes, GivesObjFilesColours) {
  output_ = folder_ / "out.obj";
  ASSERT_EQ(reconstruct({"--keep-attributes"}).exit_code, 0);
  const std::string text = read_file(output_);
  EXPECT_EQ(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find('\n')), ' '), 6) << text;
  EXPECT_EQ(pointskin_run({"check", output_}).exit_code, 0);
}

TEST_F(KeepAttributes, IsInTheReportTheEstimateAndTheRepeatedRuns) {
  const std::string report = folder_ / "report.json";
  ASSERT_EQ(reconstruct({"--keep-attributes", "--report", report, "--repeat", "2"}).exit_code, 0);
  const auto json = nlohmann::json::parse(read_file(report));
  EXPECT_EQ(json["options"]["attributes"], true);
  const auto estimate = [&](const Args& more) {
    Args args = {"reconstruct", input_, "--dry-run", "--depth", "6"};
    args.insert(args.end(), more.begin(), more.end());
    const std::string text = pointskin_run(args).out;
    return std::stod(text.substr(text.find('(') + 1));
  };
  EXPECT_NEAR(estimate({"--keep-attributes"}), json["memory"]["device_peak_bytes"].get<double>(),
              0.15 * json["memory"]["device_peak_bytes"].get<double>());
  EXPECT_GT(estimate({"--keep-attributes"}), estimate({}));
}

}  // namespace
}  // namespace pointskin::test
