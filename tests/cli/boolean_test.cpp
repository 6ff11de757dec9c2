// pointskin boolean: what it writes, reports and refuses.
#include <algorithm>
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

class BooleanCommand : public testing::Test {
 protected:
  BooleanCommand() {
    write_file(a_, ply_bytes(sphere(4000)));
    write_file(b_, ply_bytes(sphere(4000, {1, 0.1F, 0})));
    write_file(mesh_, cube_mesh_ply(4));
  }

  Result boolean(const std::string& a, const std::string& b, const std::string& op, const Args& more = {}) {
    Args args = {"boolean", a, b, "--op", op, "-o", output_, "--depth", "6", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// One line of error, this code, and no output.
  void expect_failure(const Result& result, int code, const std::string& part) {
    expect_error(result, code, part);
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string a_ = folder_ / "a.ply";
  std::string b_ = folder_ / "b.ply";
  std::string mesh_ = folder_ / "mesh.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(BooleanCommand, WritesAWatertightMeshForEveryOperation) {
  std::vector<double> volumes;
  for (const char* op : {"union", "intersection", "difference", "symmetric-difference"}) {
    const Result result = boolean(a_, b_, op);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out, "");
    const MeshReport report = measure(read_mesh(output_));
    EXPECT_TRUE(report.watertight()) << op;
    volumes.push_back(report.volume);
  }
  const double ball = 4.18879;
  EXPECT_NEAR(volumes[0] + volumes[1], 2 * ball, 0.1);
  EXPECT_NEAR(volumes[2] + volumes[1], ball, 0.1);
  EXPECT_NEAR(volumes[3] + volumes[1], volumes[0], 0.15);
}

TEST_F(BooleanCommand, ReportsWhatItDid) {
  const std::string cloud = folder_ / "cloud.ply";
  const Result result = boolean(a_, mesh_, "difference", {"--report", folder_ / "r.json", "--cloud", cloud});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(read_file(folder_ / "r.json"));
  const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/boolean.schema.json"));
  EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>());
  EXPECT_EQ(report["op"], "difference");
  EXPECT_EQ(report["a"]["kind"], "cloud");
  EXPECT_EQ(report["a"]["points"], 4000);
  EXPECT_EQ(report["b"]["kind"], "mesh");
  EXPECT_EQ(report["b"]["flipped"], report["b"]["kept"]);
  EXPECT_GT(report["added"], 0);
  const Cloud written = read_cloud(cloud);
  EXPECT_TRUE(written.has_normals());
  EXPECT_EQ(written.size(), report["a"]["kept"].get<std::int64_t>() + report["b"]["kept"].get<std::int64_t>() +
                                report["added"].get<std::int64_t>());
  EXPECT_EQ(report["result"]["points"], written.size());
}

TEST_F(BooleanCommand, SaysWhatItDidOnOneLineUnlessQuiet) {
  const Result result = pointskin_run({"boolean", a_, b_, "--op", "union", "-o", output_, "--depth", "5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("of 4000 points kept"), std::string::npos) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
}

TEST_F(BooleanCommand, SaysWhereFloatsAreTooCoarseForTheCells) {
  const Result result = boolean(a_, b_, "union", {"--shift", "1e6,0,0", "--report", folder_ / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("relative to 1000000 0 0, in steps of 0.0625 where cells are "), std::string::npos)
      << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(Json::parse(read_file(folder_ / "r.json"))["warnings"].size(), 1);
}

TEST_F(BooleanCommand, WritesPlyToStdoutAndReadsStdin) {
  const Result file = boolean(a_, b_, "union");
  ASSERT_EQ(file.exit_code, 0) << file.err;
  Start start;
  start.args = {"boolean", "-", b_, "--op", "union", "-o", "-", "--depth", "6", "-q"};
  start.input = ply_bytes(sphere(4000));
  const Result piped = run_program(start);
  ASSERT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_EQ(piped.out, read_file(output_));
}

TEST_F(BooleanCommand, EmptyResultsAreExitCode5) {
  expect_failure(boolean(a_, a_, "difference"), 5, "difference is empty");
  expect_failure(boolean(a_, a_, "symmetric-difference"), 5, "symmetric difference is empty");
  write_file(b_, ply_bytes(sphere(2000, {4, 0, 0})));
  expect_failure(boolean(a_, b_, "intersection"), 5, "intersection is empty");
}

TEST_F(BooleanCommand, RefusesWhatItCannotDoInOneLine) {
  expect_failure(boolean(a_, b_, "minus"), 2, "--op");
  expect_failure(boolean(a_, b_, "union", {"--creases", "soft"}), 2, "--creases");
  expect_failure(boolean(a_, b_, "union", {"--coincidence", "-1"}), 2, "--coincidence");
  expect_failure(boolean(a_, b_, "union", {"--cloud", "-"}), 2, "--cloud");
  expect_failure(boolean(a_, b_, "union", {"--cloud", folder_ / "c.obj"}), 2, ".ply");
  expect_failure(boolean(a_, b_, "union", {"--report", output_}), 2, "same file");
  expect_failure(boolean(a_, b_, "union", {"--report", a_}), 2, "overwrite");
  expect_failure(boolean("-", "-", "union"), 2, "stdin");
  expect_failure(boolean(a_, folder_ / "none.ply", "union"), 3, "none.ply");
  write_file(b_, ply_bytes(sphere(100), false));
  expect_failure(boolean(a_, b_, "union"), 4, "normals");
  write_file(mesh_, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::filesystem::rename(mesh_, folder_ / "open.obj");
  expect_failure(boolean(a_, folder_ / "open.obj", "union"), 3, "closed");
  EXPECT_EQ(pointskin_run({"boolean", a_, b_, "-o", output_}).exit_code, 2);
  EXPECT_EQ(pointskin_run({"boolean", a_, "--op", "union", "-o", output_}).exit_code, 2);
}

}  // namespace
}  // namespace pointskin::test
