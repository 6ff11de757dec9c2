// pointskin edit: scripts that part two fingers, are undone, saved and replayed; what is refused.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"
#include "support/two_fingers.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

const char kCamera[] =
    R"({"view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "projection": [0.5,0,0,0, 0,0.5,0,0, 0,0,1,0, 0,0,0,1],
        "width": 400, "height": 400})";

std::string script_with(const std::string& operations) {
  return R"({"version": 1, "operations": [)" + operations + "]}";
}

/// Up along the hidden face of the left finger.
std::string stroke() {
  return std::string(R"({"op": "guide", "camera": )") + kCamera +
         R"(, "stroke": [[194, 275], [194, 125]], "normals": "stroke"})";
}

class EditCommand : public testing::Test {
 protected:
  EditCommand() { write_cloud(input_, two_fingers_cloud(20'000, 1)); }

  Result edit(const std::string& script, const Args& more = {}) {
    write_file(script_, script);
    Args args = {"edit", input_, "--script", script_, "-o", output_, "--depth", "6"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  void expect_failure(const std::string& script, int code, const std::string& part) {
    const Result result = edit(script);
    expect_error(result, code, part);
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "fingers.ply";
  std::string script_ = folder_ / "ops.json";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(EditCommand, PartsWhatReconstructJoinsAndReportsIt) {
  const std::string report = folder_ / "report.json";
  const Result result = edit(script_with(stroke()), {"--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("components 1 -> 2"), std::string::npos) << result.err;
  EXPECT_EQ(measure(read_mesh(output_)).components, 2);
  const Json json = Json::parse(read_file(report));
  const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/edit.schema.json"));
  EXPECT_TRUE(schema_violations(schema, json).empty());
  EXPECT_EQ(json["steps"][0]["before"]["components"], 1);
  EXPECT_EQ(json["steps"][0]["after"]["components"], 2);
  EXPECT_TRUE(json["mesh"]["closed"]);
}

/// The cameras of a script of strokes through empty corners of the picture, as matrices.
Json cameras_of(const std::string& saved) {
  Json cameras = Json::array();
  const Json script = Json::parse(read_file(saved));
  for (const Json& operation : script["operations"]) cameras.push_back(operation["camera"]);
  return cameras;
}

TEST_F(EditCommand, CamerasOfPicturesFitASphereUnlessTheyAskForAnother) {
  const auto with = [](const std::string& camera) {
    return R"({"op": "guide", "camera": )" + camera + R"(, "stroke": [[600, 450], [604, 400]], "inside_only": false})";
  };
  const std::string saved = folder_ / "saved.json";
  ASSERT_EQ(edit(script_with(with(R"({"azimuth": 10})")), {"--save", saved}).exit_code, 0);
  const Json plain = cameras_of(saved)[0];
  // R / sin(14 degrees) from the middle of the box of the surface.
  ASSERT_EQ(pointskin_run({"reconstruct", input_, "-o", folder_ / "plain.ply", "--depth", "6"}).exit_code, 0);
  const Mesh mesh = read_mesh(folder_ / "plain.ply");
  const Bounds box = bounds_of(mesh.vertices);
  const double middle[3] = {(double{box.lower.x} + box.upper.x) / 2, (double{box.lower.y} + box.upper.y) / 2,
                            (double{box.lower.z} + box.upper.z) / 2};
  double radius = 0;
  for (const Vec3f& v : mesh.vertices)
    radius = std::max(radius, std::hypot(v.x - middle[0], v.y - middle[1], v.z - middle[2]));
  double depth = plain["view"][11].get<double>();
  for (std::size_t a = 0; a < 3; ++a) depth += plain["view"][8 + a].get<double>() * middle[a];
  EXPECT_NEAR(-depth, radius / std::sin(14 * std::acos(-1.0) / 180), 1e-6);
  EXPECT_NEAR(plain["projection"][5].get<double>(), 0.92 / std::tan(14 * std::acos(-1.0) / 180), 1e-9);
  ASSERT_EQ(edit(script_with(with(R"({"azimuth": 10, "fit": "sphere", "zoom": 1})")), {"--save", saved}).exit_code, 0);
  EXPECT_EQ(cameras_of(saved)[0], plain);
  for (const char* other :
       {R"("fit": "box")", R"("zoom": 2)", R"("fov": 50)", R"("up": "-y")", R"("target": [0, 1, 0])"}) {
    const std::string camera = std::string(R"({"azimuth": 10, )") + other + "}";
    ASSERT_EQ(edit(script_with(with(camera)), {"--save", saved}).exit_code, 0) << other;
    EXPECT_NE(cameras_of(saved)[0], plain) << other;
  }
  std::filesystem::remove(output_);
  expect_failure(script_with(with(R"({"fit": "tight"})")), 3, "fit");
  expect_failure(script_with(with(R"({"up": "w"})")), 3, "up");
}

TEST_F(EditCommand, WithoutOperationsGivesTheBytesOfReconstruct) {
  ASSERT_EQ(edit(script_with("")).exit_code, 0);
  const std::string plain = folder_ / "plain.ply";
  ASSERT_EQ(pointskin_run({"reconstruct", input_, "-o", plain, "--depth", "6"}).exit_code, 0);
  EXPECT_EQ(read_file(output_), read_file(plain));
}

TEST_F(EditCommand, UndoBringsTheOldBytesBackAndASavedScriptReplays) {
  ASSERT_EQ(edit(script_with("")).exit_code, 0);
  const std::string untouched = read_file(output_);
  ASSERT_EQ(edit(script_with(stroke() + R"(, {"op": "undo"})")).exit_code, 0);
  EXPECT_EQ(read_file(output_), untouched);
  const std::string saved = folder_ / "saved.json";
  const std::string points = folder_ / "points.ply";
  ASSERT_EQ(
      edit(script_with(
               R"({"op": "guide", "camera": {"azimuth": 0, "elevation": 0}, "rectangle": [590, 400, 610, 500]}, )" +
               stroke() + R"(, {"op": "undo"}, {"op": "redo"})"),
           {"--save", saved, "--cloud", points})
          .exit_code,
      0);
  const std::string edited = read_file(output_);
  EXPECT_NE(edited, untouched);
  const std::string edited_points = read_file(points);
  ASSERT_EQ(edit(read_file(saved), {"--cloud", points, "--threads", "1"}).exit_code, 0);
  EXPECT_EQ(read_file(output_), edited);
  EXPECT_EQ(read_file(points), edited_points);
  EXPECT_EQ(read_cloud(points).attributes.at(0).name, "added");
}

TEST_F(EditCommand, SavesPartsByTheFolderOfTheScript) {
  write_file(folder_ / "part.ply", ply_bytes(sphere(2000)));
  std::filesystem::create_directory(folder_ / "deeper");
  const std::string saved = folder_ / "deeper/saved.json";
  ASSERT_EQ(edit(script_with(R"({"op": "insert", "file": "part.ply", "box": {"lower": [0, -1, -1]}, "scale": 0.2,
                                 "rotation": {"axis": [0, 0, 1], "degrees": 90}, "translation": [1.5, 0, 0]})"),
                 {"--save", saved})
                .exit_code,
            0);
  const std::string edited = read_file(output_);
  const Json json = Json::parse(read_file(saved));
  EXPECT_EQ(json["operations"][0]["file"], "../part.ply");
  ASSERT_EQ(pointskin_run({"edit", input_, "--script", saved, "-o", output_, "--depth", "6"}).exit_code, 0);
  EXPECT_EQ(read_file(output_), edited);
}

TEST_F(EditCommand, FlipsAndRemovesTheFrontAndInsertsWhatAViewShows) {
  write_file(folder_ / "part.ply", ply_bytes(sphere(2000)));
  const std::string front = std::string(R"("camera": )") + kCamera + R"(, "rectangle": [150, 150, 250, 250], )";
  const std::string script = script_with(R"({"op": "flip", )" + front + R"("layers": "front"}, {"op": "flip", )" +
                                         front + R"("layers": "through"},
         {"op": "remove", )" + front + R"("originals": true, "layers": "front"}, {"op": "insert", )" +
                                         front + R"("file": "part.ply"})");
  const std::string saved = folder_ / "saved.json";
  const std::string report = folder_ / "report.json";
  const Result result = edit(script, {"--save", saved, "--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string edited = read_file(output_);
  const Json steps = Json::parse(read_file(report))["steps"];
  const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/edit.schema.json"));
  EXPECT_TRUE(schema_violations(schema, Json::parse(read_file(report))).empty());
  const auto flipped = steps[0]["flipped"].get<std::int64_t>();
  EXPECT_GT(flipped, 100);
  EXPECT_GT(steps[1]["flipped"], flipped) << "both sides";
  EXPECT_NE(result.err.find(std::to_string(flipped) + " turned"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("changes no point"), std::string::npos) << result.err;
  EXPECT_GT(steps[2]["removed"], 100);
  EXPECT_LT(steps[2]["removed"], steps[1]["flipped"]);
  EXPECT_GT(steps[3]["added"], 50);
  EXPECT_LT(steps[3]["added"], 1000) << "the part has 2000 points";
  const Json operations = Json::parse(read_file(saved))["operations"];
  EXPECT_EQ(operations[0]["layers"], "front");
  EXPECT_EQ(operations[1]["layers"], "through");
  EXPECT_EQ(operations[3]["area"][0].size(), 4U);
  ASSERT_EQ(edit(read_file(saved)).exit_code, 0);
  EXPECT_EQ(read_file(output_), edited);
}

TEST_F(EditCommand, RefusesScriptsThatAreWrong) {
  expect_failure("{", 3, "is not JSON");
  expect_failure(R"({"operations": []})", 3, "needs the key 'version'");
  expect_failure(R"({"version": 2, "operations": []})", 3, "must be a whole number in 1..1");
  expect_failure(script_with(R"({"op": "bend"})"), 3, "operations[0].op");
  expect_failure(script_with(R"({"op": "guide", "stroke": [[1, 2]]})"), 3, "needs the key 'camera'");
  expect_failure(script_with(stroke() + R"(, {"op": "guide", "camera": {}, "stroke": [[1]]})"), 3,
                 "operations[1].stroke[0]: must be a list of 2");
  expect_failure(script_with(R"({"op": "guide", "camera": {"azimut": 3}, "stroke": [[1, 2]]})"), 3, "azimut");
  expect_failure(script_with(R"({"op": "guide", "camera": {}})"), 2, "stroke or an area");
  expect_failure(script_with(R"({"op": "undo"})"), 2, "nothing to undo");
  expect_failure(script_with(R"({"op": "insert", "file": "missing.ply"})"), 3, "missing.ply");
  expect_failure(script_with(R"({"op": "remove", "camera": {}, "layers": "back"})"), 3, "operations[0].layers");
  expect_failure(script_with(R"({"op": "flip", "camera": {}, "originals": true})"), 3, "originals");
  expect_failure(script_with(R"({"op": "flip", "camera": {}})"), 2, "no area");
  expect_failure(script_with(R"({"op": "insert", "file": "p.ply", "camera": {}, "rectangle": [0, 0, 9, 9]})"), 3,
                 "operations[0].camera");
  expect_failure(script_with(R"({"op": "insert", "file": "p.ply", "rectangle": [0, 0, 9, 9]})"), 3, "camera");
  expect_failure(script_with(std::string(R"({"op": "insert", "file": "p.ply", "camera": )") + kCamera + "}"), 3,
                 "no area");
  expect_failure(script_with(R"({"op": "remove", "camera": {}, "rectangle": [0, 0, 1200, 900], "originals": true})"), 5,
                 "remove all points");
}

TEST_F(EditCommand, RefusesFilesThatAreWrong) {
  write_file(script_, script_with(""));
  EXPECT_EQ(pointskin_run({"edit", input_, "--script", folder_ / "none.json", "-o", output_}).exit_code, 3);
  EXPECT_EQ(pointskin_run({"edit", input_, "-o", output_}).exit_code, 2);
  EXPECT_EQ(pointskin_run({"edit", folder_ / "none.ply", "--script", script_, "-o", output_}).exit_code, 3);
  EXPECT_EQ(pointskin_run({"edit", input_, "--script", script_, "-o", "/proc/x.ply"}).exit_code, 8);
  EXPECT_EQ(pointskin_run({"edit", input_, "--script", script_, "-o", output_, "--depth", "40"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(output_));
}

}  // namespace
}  // namespace pointskin::test
