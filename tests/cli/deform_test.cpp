// pointskin deform: files, frames, the report, and what is wrong with scripts.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

constexpr const char* kBend = R"({"handles": [
  {"region": {"half_space": {"point": [-0.5, 0, 0], "normal": [-1, 0, 0]}}},
  {"region": {"half_space": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}},
   "rigid": {"axis": [0, 0, 1], "point": [0, 1.5, 0], "degrees": 60}}]})";

class DeformCommand : public testing::Test {
 protected:
  DeformCommand() {
    write_file(input_, ply_bytes(sphere(4000)));
    write_file(script_, kBend);
  }

  Result deform(const Args& more) {
    Args args = {"deform", input_, "--script", script_, "--depth", "5", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// One line of error, this code, and no output.
  void expect_failure(const Args& more, int code, const std::string& part) {
    const Result result = deform(more);
    expect_error(result, code, part);
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "sphere.ply";
  std::string script_ = folder_ / "bend.json";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(DeformCommand, WritesAWatertightMeshAndTheDeformedPoints) {
  const Result result = deform({"-o", output_, "--cloud", folder_ / "points.ply"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(measure(read_mesh(output_)).watertight());
  const Cloud cloud = read_cloud(folder_ / "points.ply");
  EXPECT_TRUE(cloud.has_normals());
  // The rightmost point is turned by 60 degrees about (0, 1.5).
  const double x = 0.5 + 1.5 * std::sqrt(0.75);
  const double y = 1.5 + std::sqrt(0.75) - 0.75;
  double nearest = 1;
  for (const Vec3f& p : cloud.positions)
    nearest = std::min(nearest, std::hypot(double{p.x} - x, double{p.y} - y, double{p.z}));
  EXPECT_LT(nearest, 0.1);
}

TEST_F(DeformCommand, WritesFramesFromTheRestPoseToTheDeformation) {
  const Result result = deform({"-o", folder_ / "bend_{}.ply", "--frames", "11", "--report", folder_ / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Result plain = pointskin_run({"reconstruct", input_, "-o", output_, "--depth", "5", "-q"});
  ASSERT_EQ(plain.exit_code, 0);
  EXPECT_EQ(read_file(folder_ / "bend_00.ply"), read_file(output_));
  ASSERT_EQ(deform({"-o", output_}).exit_code, 0);
  EXPECT_EQ(read_file(folder_ / "bend_10.ply"), read_file(output_));

  const Json report = Json::parse(read_file(folder_ / "r.json"));
  const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/deform.schema.json"));
  EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
  ASSERT_EQ(report["frames"].size(), 11U);
  for (const Json& frame : report["frames"]) {
    EXPECT_TRUE(frame["mesh"]["closed"]);
    EXPECT_EQ(frame["points"], 4000 + frame["inserted"].get<int>() - frame["thinned"].get<int>());
    EXPECT_GT(frame["spacing"]["p05"], 0.5);
    EXPECT_LT(frame["spacing"]["p95"], 2);
  }
  EXPECT_EQ(report["frames"][0]["inserted"], 0);
  EXPECT_GT(report["frames"][10]["inserted"], 0);
}

TEST_F(DeformCommand, TakesLatticesAndAllRegions) {
  write_file(script_, R"({"handles": [
    {"region": {"ball": {"centre": [1, 0, 0], "radius": 0.2}}, "affine": {"matrix": [[2, 0, 0, 0.5], [0, 2, 0, 0], [0, 0, 2, 0]], "pivot": [1, 0, 0]}},
    {"region": {"box": {"lower": [-1, -1, -1], "upper": [-0.8, 1, 1]}}},
    {"region": {"capsule": {"from": [0, 1, -0.2], "to": [0, 1, 0.2], "radius": 0.1}}, "rigid": {"translation": [0, 0.5, 0]}},
    {"region": {"points": [0, 17]}}],
    "lattices": [{"box": {"lower": [-2, -2, -2], "upper": [2, 2, 2]}, "spans": [2, 2, 2], "moves": [{"at": [1, 1, 2], "by": [0, 0, 0.4]}], "outside": "stay"},
                 {"origin": [-2, -2, -2], "axes": [[4, 0, 0], [0, 4, 0], [0, 0, 4]], "spans": [1, 1, 1],
                  "control": [[-2, -2, -2], [-2, -2, 2], [-2, 2, -2], [-2, 2, 2], [2, -2, -2], [2, -2, 2], [2, 2, -2], [3, 3, 3]]}]})");
  const Result result = deform({"-o", output_});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(measure(read_mesh(output_)).watertight());
}

TEST_F(DeformCommand, RefusesOptionsThatMakeNoSense) {
  expect_failure({}, 2, "no output");
  expect_failure({"-o", output_, "--frames", "1"}, 2, "--frames");
  expect_failure({"-o", output_, "--frames", "3"}, 2, "{}");
  expect_failure({"-o", output_, "--cloud", output_}, 2, "same file");
  expect_failure({"--cloud", folder_ / "points.obj"}, 2, ".ply");
  expect_failure({"-o", output_, "--depth", "0"}, 2, "depth");
  expect_failure({"-o", output_, "--report", input_}, 2, "overwrite");
  expect_failure({"-o", folder_ / "no/where.ply"}, 8, "where.ply");
}

TEST_F(DeformCommand, SaysWhereAScriptIsWrong) {
  const auto expect_story = [&](const std::string& text, const std::string& part) {
    SCOPED_TRACE(text);
    write_file(script_, text);
    expect_failure({"-o", output_}, 3, part);
  };
  const auto handle = [](const std::string& rest) { return R"({"handles": [{"region": )" + rest + "}]}"; };
  const std::string ball = R"({"ball": {"centre": [0, 0, 0], "radius": 1}})";
  expect_story("", "is not JSON");
  expect_story("{", "is not JSON");
  expect_story("[]", "must be an object");
  expect_story(R"({"handle": []})", "does not know the key 'handle'");
  expect_story(R"({"handles": {}})", "handles: must be a list");
  expect_story(R"({"handles": [{}]})", "handles[0]: needs the key 'region'");
  expect_story(handle("{}"), "must have one of");
  expect_story(handle(R"({"ball": {"centre": [0, 0], "radius": 1}})"), "centre: must be a list of 3");
  expect_story(handle(R"({"ball": {"centre": [0, "a", 0], "radius": 1}})"), "centre[1]: must be a number");
  expect_story(handle(R"({"ball": {"centre": [0, 1e999, 0], "radius": 1}})"), "too large");
  expect_story(handle(R"({"ball": {"centre": [0, 0, 0], "radius": -1}})"), "the radius must not be negative");
  expect_story(handle(R"({"half_space": {"point": [0, 0, 0], "normal": [0, 0, 0]}})"), "the normal must not be zero");
  expect_story(handle(R"({"points": [0, 4000]})"), "not in the cloud");
  expect_story(handle(R"({"points": [-1]})"), "points[0]: must be a whole number");
  expect_story(handle(R"({"points": [1.5]})"), "points[0]: must be a whole number");
  expect_story(handle(R"({"points": [99999999999999999999]})"), "");
  expect_story(handle(R"({"points": []})"), "must not be empty");
  expect_story(handle(ball + R"(, "rigid": {}, "affine": {"matrix": []})"), "both");
  expect_story(handle(ball + R"(, "rigid": {"degrees": 1e9})"), "the angle");
  expect_story(handle(ball + R"(, "rigid": {"axis": [0, 0, 0], "degrees": 9})"), "the axis");
  expect_story(handle(ball + R"(, "affine": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0]]})"), "matrix: must be a list of 3");
  expect_story(handle(ball + R"(, "affine": {"matrix": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]})"), "mirror");
  const auto lattice = [](const std::string& rest) { return R"({"lattices": [{)" + rest + "}]}"; };
  const std::string box = R"("box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}, )";
  expect_story(lattice(R"("spans": [1, 1, 1])"), "origin");
  expect_story(lattice(box + R"("spans": [0, 1, 1])"), "spans[0]");
  expect_story(lattice(box + R"("spans": [1, 16, 1])"), "spans[1]");
  expect_story(lattice(box + R"("spans": [1, 1, 1], "control": [[0, 0, 0]])"), "must be a list of 8");
  expect_story(lattice(box + R"("spans": [1, 1, 1], "moves": [{"at": [2, 0, 0], "by": [0, 0, 0]}])"), "at[0]");
  expect_story(lattice(box + R"("spans": [1, 1, 1], "outside": "tear")"), "must be one of extend, stay");
  expect_story(lattice(R"("box": {"lower": [0, 0, 0], "upper": [0, 1, 1]}, "spans": [1, 1, 1])"), "below upper");
  write_file(script_, kBend);
  std::filesystem::remove(script_);
  expect_failure({"-o", output_}, 3, "cannot be read");
}

}  // namespace
}  // namespace pointskin::test
