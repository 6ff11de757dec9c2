// pointskin fluid: single frames, sequences, the report, and what is wrong with them.
#include <algorithm>
#include <cstddef>
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

/// A block of 6 x 6 x 6 particles of radius 1 as legacy VTK, with a velocity; `shift` along x.
std::string block_vtk(double shift) {
  std::string points;
  std::string velocities;
  for (int i = 0; i < 216; ++i) {
    points += std::to_string(2 * (i / 36) + shift) + " " + std::to_string(2 * (i / 6 % 6)) + " " +
              std::to_string(2 * (i % 6)) + "\n";
    velocities += "1 0 " + std::to_string(i / 36) + "\n";
  }
  return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 216 float\n" + points +
         "POINT_DATA 216\nVECTORS velocity float\n" + velocities;
}

class FluidCommand : public testing::Test {
 protected:
  FluidCommand() {
    for (const int frame : {8, 9, 10, 11, 12})
      write_file(folder_ / ("frame_" + std::to_string(frame) + ".vtk"), block_vtk(0.1 * frame));
    write_file(folder_ / "frame_x.vtk", "not a frame");
  }

  /// With a radius and a cube size of 1 unless others are given.
  Result fluid(const std::string& input, const Args& more) {
    Args args = {"fluid", input, "-q"};
    for (const char* option : {"-r", "-c"})
      if (std::find(more.begin(), more.end(), option) == more.end()) args.insert(args.end(), {option, "1"});
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  void expect_failure(const std::string& input, const Args& more, int code, const std::string& part) {
    const Result result = fluid(input, more);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }

  TemporaryFolder folder_;
  std::string one_ = folder_ / "frame_9.vtk";
  std::string all_ = folder_ / "frame_{}.vtk";
  std::string output_ = folder_ / "mesh.ply";
};

TEST_F(FluidCommand, WritesAWatertightMeshWithVelocities) {
  const Result result = fluid(one_, {"-o", output_});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const Mesh mesh = read_mesh(output_);
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.watertight());
  EXPECT_NEAR(report.volume, 1728, 0.15 * 1728);  // edges and corners are rounded
  ASSERT_EQ(mesh.attributes.size(), 3U);
  EXPECT_EQ(mesh.attributes[2].name, "velocity_z");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_NEAR(mesh.attributes[0].values.at(v), 1, 1e-5);
}

TEST_F(FluidCommand, WritesSequencesInNaturalOrderWhateverRunsTogether) {
  for (const char* at_once : {"1", "3"}) {
    const std::string out = folder_ / (std::string(at_once) + "_{}.ply");
    const std::string json = folder_ / "r.json";
    const Result result = fluid(all_, {"-o", out, "--first", "9", "--last", "11", "--at-once", at_once, "--threads",
                                       "3", "--report", json, "--mesh-smoothing-iters", "3"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(read_file(json));
    const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/fluid.schema.json"));
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
    ASSERT_EQ(report["frames"].size(), 3U);
    for (int i = 0; i < 3; ++i) {
      const Json& frame = report["frames"][static_cast<std::size_t>(i)];
      EXPECT_EQ(frame["input"], folder_ / ("frame_" + std::to_string(9 + i) + ".vtk"));
      EXPECT_EQ(frame["particles"], 216);
      EXPECT_TRUE(frame["mesh"]["closed"]);
      EXPECT_EQ(frame["mesh"]["components"], 1);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / (std::string(at_once) + "_8.ply")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / (std::string(at_once) + "_12.ply")));
  }
  for (const char* number : {"9", "10", "11"})
    EXPECT_EQ(read_file(folder_ / (std::string("1_") + number + ".ply")),
              read_file(folder_ / (std::string("3_") + number + ".ply")));
}

TEST_F(FluidCommand, TakesEveryOption) {
  ASSERT_EQ(fluid(one_, {"-o", output_, "--kernel", "anisotropic", "--min-component", "5", "--smoothing-length", "2.5",
                         "--surface-threshold", "0.3", "--mesh-smoothing-iters", "5", "--no-smoothing-weights",
                         "--no-normals", "--no-attributes", "--max-memory", "1G", "--device", "cpu"})
                .exit_code,
            0);
  const Mesh mesh = read_mesh(output_);
  EXPECT_TRUE(measure(mesh).watertight());
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.attributes.empty());
}

TEST_F(FluidCommand, ReadsStdinAndWritesStdout) {
  Start start;
  start.args = {"fluid", "-", "-r", "1", "-o", "-", "-q"};
  start.input = "[[0,0,0],[2,0,0],[0,2,0]]";
  const Result result = run_program(start);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  write_file(output_, result.out);
  EXPECT_EQ(measure(read_mesh(output_)).components, 1);
}

TEST_F(FluidCommand, SaysWhatIsWrong) {
  expect_failure(one_, {"-o", output_, "-r", "0"}, 2, "particle_radius");
  expect_failure(one_, {"-o", output_, "-c", "9"}, 2, "--cube-size");
  expect_failure(one_, {"-o", folder_ / "m_{}.ply"}, 2, "{}");
  expect_failure(all_, {"-o", output_}, 2, "{}");
  expect_failure(one_, {"-o", output_, "--first", "3"}, 2, "--first");
  expect_failure(one_, {"-o", one_}, 2, "");
  expect_failure(folder_ / "none_{}.vtk", {"-o", folder_ / "m_{}.ply"}, 3, "no such file");
  expect_failure(all_, {"-o", folder_ / "m_{}.ply", "--first", "30"}, 3, "no such file");
  expect_failure(folder_ / "none.vtk", {"-o", output_}, 3, "none.vtk");
  expect_failure(folder_ / "frame_x.vtk", {"-o", output_}, 3, "frame_x.vtk");
  write_file(folder_ / "far.xyz", "0 0 0\n1e9 0 0\n");
  expect_failure(folder_ / "far.xyz", {"-o", output_, "--shift", "none"}, 6, "2^20");
  write_file(folder_ / "empty.json", "[]");
  expect_failure(folder_ / "empty.json", {"-o", output_}, 5, "no particles");
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(FluidCommand, OneBadFrameEndsASequenceWithItsName) {
  write_file(folder_ / "frame_11.vtk", "# vtk DataFile Version 3.0\nbroken\n");
  for (const char* at_once : {"1", "2"})
    expect_failure(all_, {"-o", folder_ / "m_{}.ply", "--device", "cpu", "--at-once", at_once, "--threads", "2"}, 3,
                   "frame_11.vtk");
}

}  // namespace
}  // namespace pointskin::test
