// Properties of points keep their types through every command that carries them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "support/attributes.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;
using Json = nlohmann::json;
using enum AttributeType;

constexpr std::int32_t kFirst = 1'999'999'001;

/// A sphere whose points carry a label of their own, a GPS time, and a value of every other type.
Cloud rich_sphere(int count, const Vec3f& centre = {}) {
  Cloud cloud;
  std::vector<std::int32_t> label;
  std::vector<double> time;
  for (const Sample& s : sphere(count, centre)) {
    label.push_back(kFirst + static_cast<std::int32_t>(label.size()));
    time.push_back(4e8 + 1e-6 * static_cast<double>(time.size()));
    cloud.positions.push_back(s.position);
    cloud.normals.push_back(s.normal);
  }
  const auto rising = [&](const Vec3f& p) { return 50 + 40 * (p.z - centre.z); };
  cloud.attributes = {{"label", label},
                      {"gps_time", time},
                      attribute_of<std::int8_t>("tilt", cloud.positions, rising),
                      attribute_of<std::uint8_t>("red", cloud.positions, rising),
                      attribute_of<std::int16_t>("angle", cloud.positions, rising),
                      attribute_of<std::uint16_t>("intensity", cloud.positions, rising),
                      attribute_of<std::uint32_t>("block", cloud.positions, rising),
                      attribute_of<float>("height", cloud.positions, rising)};
  return cloud;
}

std::string types_of(const std::vector<Attribute>& attributes) {
  std::string text;
  for (const Attribute& a : attributes) text += a.name + " " + name_of(a.type()) + "\n";
  return text;
}

const AttributeValues& named(const std::vector<Attribute>& attributes, const std::string& name) {
  const auto at =
      std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  if (at == attributes.end()) throw std::logic_error("there is no " + name);
  return at->values;
}

class Types : public testing::Test {
 protected:
  Types() { write_cloud(input_, cloud_); }

  void run(const Args& args) {
    const Result result = pointskin_run(args);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("error"), std::string::npos) << result.err;
  }

  /// Every point of `found` has the values of a point of the input with its label.
  void expect_points_of_input(const Cloud& found) {
    ASSERT_EQ(types_of(found.attributes).find(types_of(cloud_.attributes)), 0U) << types_of(found.attributes);
    const std::vector<std::int32_t>& labels = found.attributes[0].values.as<std::int32_t>();
    std::vector<std::int64_t> points;
    for (const std::int32_t label : labels) points.push_back(label - kFirst);
    for (std::size_t a = 0; a < cloud_.attributes.size(); ++a)
      EXPECT_TRUE(same_bytes(found.attributes[a].values, cloud_.attributes[a].values.gather(points)))
          << cloud_.attributes[a].name;
  }

  TemporaryFolder folder_;
  Cloud cloud_ = rich_sphere(4000);
  std::string input_ = folder_ / "rich.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(Types, ConvertKeepsEveryByteOfCloudsAndMeshes) {
  run({"convert", input_, output_});
  EXPECT_EQ(read_file(output_), read_file(input_));
  const Mesh mesh{{}, cloud_.positions, cloud_.normals, cloud_.attributes, {{0, 1, 2}}};
  write_mesh(input_, mesh);
  run({"convert", input_, output_});
  EXPECT_EQ(read_file(output_), read_file(input_));
}

TEST_F(Types, InfoNamesThem) {
  const std::string text = pointskin_run({"info", input_}).out;
  EXPECT_NE(text.find("label (int32), gps_time (float64), tilt (int8), red (uint8), angle (int16), intensity (uint16), "
                      "block (uint32), height (float32)"),
            std::string::npos)
      << text;
  const Json info = Json::parse(pointskin_run({"info", input_, "--json"}).out);
  EXPECT_EQ(info["attributes"][1], (Json{{"name", "gps_time"}, {"type", "float64"}}));
}

TEST_F(Types, OfTextColumnsFollowTheirValues) {
  const std::string csv = folder_ / "a.csv";
  write_file(csv, "x,y,z,label,gps_time,height\n0,0,0,16777217,400000000.000001,0.5\n1,1,1,3,400000000.000002,0.1\n");
  run({"convert", csv, output_});
  const Cloud cloud = read_cloud(output_);
  EXPECT_EQ(types_of(cloud.attributes), "label int32\ngps_time float64\nheight float32\n");
  EXPECT_EQ(cloud.attributes[0].values.at(0), 16777217);
  EXPECT_EQ(cloud.attributes[1].values.at(1), 400000000.000002);
}

TEST_F(Types, StayOnTheMesh) {
  run({"reconstruct", input_, "-o", output_, "--depth", "6", "--keep-attributes", "-q"});
  const Mesh mesh = read_mesh(output_);
  EXPECT_EQ(types_of(mesh.attributes), types_of(cloud_.attributes));
  const std::vector<std::int32_t>& labels = named(mesh.attributes, "label").as<std::int32_t>();
  const std::vector<double>& times = named(mesh.attributes, "gps_time").as<double>();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto point = static_cast<std::size_t>(labels[v] - kFirst);
    ASSERT_LT(point, cloud_.positions.size());
    const Vec3f& p = cloud_.positions[point];
    ASSERT_LT(std::hypot(p.x - mesh.vertices[v].x, p.y - mesh.vertices[v].y, p.z - mesh.vertices[v].z), 0.08);
    ASSERT_TRUE(times[v] >= 4e8 && times[v] < 4e8 + 0.004) << times[v];
  }
  EXPECT_GT(std::set<double>(times.begin(), times.end()).size(), 1000U);
}

TEST_F(Types, StayWhereScansAreMerged) {
  Cloud other = rich_sphere(4000, {4, 0, 0});
  other.attributes[0].values = std::vector<std::uint8_t>(4000, 7);  // int32 holds bytes, too
  other.attributes[3].values = std::vector<std::int8_t>(4000, -5);  // with uint8: int16
  other.attributes.pop_back();
  other.attributes.push_back({"segment", std::vector<std::uint16_t>(4000, 3)});
  const std::string second = folder_ / "other.ply";
  write_cloud(second, other);
  run({"reconstruct", input_, second, "-o", output_, "--depth", "6", "--keep-attributes", "-q"});
  const Mesh mesh = read_mesh(output_);
  EXPECT_EQ(types_of(mesh.attributes),
            "label int32\ngps_time float64\ntilt int8\nred int16\nangle int16\nintensity uint16\nblock uint32\n"
            "height float32\nsegment uint16\n");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double label = named(mesh.attributes, "label").at(v);
    ASSERT_TRUE(mesh.vertices[v].x > 2 ? label == 7 : label >= kFirst) << label;
    ASSERT_EQ(named(mesh.attributes, "segment").at(v), 3) << "the nearest point that has one";
  }
}

TEST_F(Types, OfMergedCloudsTellWhatIsMissing) {
  Cloud other = rich_sphere(4000, {4, 0, 0});
  other.attributes.clear();
  const std::string second = folder_ / "other.ply";
  write_cloud(second, other);
  run({"orient", input_, second, "-o", output_, "--no-confidence", "-q"});
  const Cloud cloud = read_cloud(output_);
  EXPECT_EQ(types_of(cloud.attributes),
            "label float64\ngps_time float64\ntilt float32\nred uint8\nangle float32\nintensity uint16\nblock float64\n"
            "height float32\n");
  EXPECT_EQ(named(cloud.attributes, "label").at(3999), kFirst + 3999);
  EXPECT_TRUE(std::isnan(named(cloud.attributes, "label").at(4000)));
}

TEST_F(Types, StayInOrientedClouds) {
  run({"orient", input_, "-o", output_, "-q"});
  const Cloud cloud = read_cloud(output_);
  EXPECT_EQ(types_of(cloud.attributes), types_of(cloud_.attributes) + "confidence float32\n");
  expect_points_of_input(cloud);
}

TEST_F(Types, StayInDeformedCloudsAndTheirMeshes) {
  const std::string script = folder_ / "bend.json";
  write_file(script, R"({"handles": [{"region": {"half_space": {"point": [-0.5, 0, 0], "normal": [-1, 0, 0]}}},
    {"region": {"half_space": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}, "rigid": {"translation": [1, 0, 0]}}]})");
  run({"deform", input_, "--script", script, "--cloud", folder_ / "points.ply", "-o", output_, "--depth", "5",
       "--keep-attributes", "-q"});
  expect_points_of_input(read_cloud(folder_ / "points.ply"));
  EXPECT_EQ(types_of(read_mesh(output_).attributes), types_of(cloud_.attributes));
}

TEST_F(Types, StayInEditedClouds) {
  const std::string part = folder_ / "part.ply";
  Cloud inserted = rich_sphere(4000);
  inserted.attributes[2].values = inserted.attributes[2].values.converted(int32);
  write_cloud(part, inserted);
  const std::string script = folder_ / "ops.json";
  write_file(script, R"({"version": 1, "operations": [
    {"op": "remove", "camera": {"azimuth": 90}, "rectangle": [500, 400, 560, 460], "originals": true},
    {"op": "insert", "file": "part.ply", "translation": [4, 0, 0]}]})");
  run({"edit", input_, "--script", script, "--cloud", folder_ / "points.ply", "-o", output_, "--depth", "5",
       "--keep-attributes", "-q"});
  Cloud cloud = read_cloud(folder_ / "points.ply");
  EXPECT_EQ(cloud.attributes[2].type(), int32) << "int8 and int32";
  cloud.attributes[2].values = cloud.attributes[2].values.converted(int8);
  ASSERT_LT(cloud.size(), 8000);
  ASSERT_GT(cloud.size(), 7000);
  expect_points_of_input(cloud);
  EXPECT_EQ(cloud.attributes.back().name, "added");
  EXPECT_EQ(cloud.attributes.back().type(), uint8);
}

TEST_F(Types, OfParticlesGoToTheMeshOfAFluid) {
  Cloud block;
  std::vector<std::int32_t> id;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      for (int z = 0; z < 10; ++z) {
        id.push_back(kFirst + static_cast<std::int32_t>(id.size()));
        block.positions.push_back(
            {2.0F * static_cast<float>(x), 2.0F * static_cast<float>(y), 2.0F * static_cast<float>(z)});
      }
  block.attributes = {{"id", id},
                      attribute_of<double>("time", block.positions, [](const Vec3f& p) { return 4e8 + 1e-4 * p.x; })};
  write_cloud(input_, block);
  run({"fluid", input_, "-o", output_, "-r", "1", "-q"});
  const Mesh mesh = read_mesh(output_);
  ASSERT_EQ(types_of(mesh.attributes), "id int32\ntime float64\n");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3f& x = mesh.vertices[v];
    const auto found = static_cast<std::size_t>(mesh.attributes[0].values.as<std::int32_t>()[v] - kFirst);
    ASSERT_LT(found, block.positions.size());
    const auto distance = [&](const Vec3f& p) { return std::hypot(p.x - x.x, p.y - x.y, p.z - x.z); };
    float best = 1e9F;
    for (const Vec3f& p : block.positions) best = std::min(best, distance(p));
    ASSERT_LE(distance(block.positions[found]), best + 1e-4F);
    const double time = mesh.attributes[1].values.at(v);
    ASSERT_NEAR(time, 4e8 + 1e-4 * x.x, 4e-4);
    ASSERT_TRUE(time >= 4e8 && time <= 4e8 + 18e-4);
  }
}

}  // namespace
}  // namespace pointskin::test
