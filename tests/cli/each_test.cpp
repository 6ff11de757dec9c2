// reconstruct --each: a mesh of every input.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"

namespace pointskin::test {
namespace {

std::string numbered(const std::string& before, int number, const std::string& behind) {
  return before + std::to_string(number) + behind;
}

class Each : public testing::Test {
 protected:
  /// Clouds of different sizes, the last the largest.
  void SetUp() override {
    for (int i = 0; i < kClouds; ++i)
      write_file(cloud(i), ply_bytes(shuffled(sphere(200 + 150 * i, {static_cast<float>(i), 0, 0}), 7)));
  }

  [[nodiscard]] std::string cloud(int i) const { return folder_ / numbered("c", i, ".ply"); }

  [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> args = {"reconstruct", "--each", "-o", folder_ / "m_{}.obj", "--depth", "4"};
    for (int i = 0; i < kClouds; ++i) args.push_back(cloud(i));
    args.insert(args.end(), more.begin(), more.end());
    return args;
  }

  void expect_as_one_by_one() const {
    for (int i = 0; i < kClouds; ++i) {
      ASSERT_EQ(pointskin_run({"reconstruct", cloud(i), "-o", folder_ / "one.obj", "--depth", "4"}).exit_code, 0);
      EXPECT_EQ(read_file(folder_ / numbered("m_c", i, ".obj")), read_file(folder_ / "one.obj")) << i;
    }
  }

  static constexpr int kClouds = 5;
  TemporaryFolder folder_;
};

TEST_F(Each, MakesTheMeshesOfOneByOne) {
  for (const char* threads : {"1", "3"}) {
    const Result result = pointskin_run(words({"--threads", threads}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("clouds 5, points 2500"), std::string::npos) << result.err;
    expect_as_one_by_one();
  }
}

TEST_F(Each, WritesAReportOfEveryCloudWithItsOwnWarnings) {
  std::vector<Sample> samples = sphere(400);
  samples[3].normal = {};
  write_file(cloud(2), ply_bytes(samples));
  const Result result =
      pointskin_run(words({"--report", folder_ / "r_{}.json", "--normals", "given", "--threads", "2"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("warning: " + cloud(2) + ": 1 points were dropped"), std::string::npos) << result.err;
  for (int i = 0; i < kClouds; ++i) {
    const auto report = nlohmann::json::parse(read_file(folder_ / numbered("r_c", i, ".json")));
    EXPECT_EQ(report["input"]["points"], i == 2 ? 400 : 200 + 150 * i);
    EXPECT_EQ(report["warnings"].size(), i == 2 ? 1 : 0) << report["warnings"];
  }
}

TEST_F(Each, AnEnvelopeIsForAllAndReportsSayWhatWasGiven) {
  const std::string hull = folder_ / "hull.ply";
  write_file(hull, cube_mesh_ply(2));
  const Result result =
      pointskin_run({"reconstruct", cloud(0), cloud(1), "--each", "-o", folder_ / "m_{}.obj", "--report",
                     folder_ / "r_{}.json", "--envelope", hull, "--depth", "4", "--threads", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto schema = nlohmann::json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json"));
  for (const char* name : {"r_c0.json", "r_c1.json"}) {
    const auto report = nlohmann::json::parse(read_file(folder_ / name));
    EXPECT_TRUE(schema_violations(schema, report).empty()) << testing::PrintToString(schema_violations(schema, report));
    EXPECT_EQ(report["envelope"]["file"], hull);
    EXPECT_EQ(report["options"]["threads"], 2);
    EXPECT_EQ(report["options"]["device"], "auto");
  }
  ASSERT_EQ(
      pointskin_run({"reconstruct", cloud(1), "-o", folder_ / "one.obj", "--envelope", hull, "--depth", "4"}).exit_code,
      0);
  EXPECT_EQ(read_file(folder_ / "m_c1.obj"), read_file(folder_ / "one.obj"));
}

TEST_F(Each, GoesOnWhereOneFailsAndEndsWithTheFirstOnesCode) {
  write_file(cloud(1), ply_bytes(sphere(300), false));
  write_file(cloud(3), "nothing");
  const Result result = pointskin_run(words({"--normals", "given", "--threads", "2"}));
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_NE(result.err.find("pointskin: 2 of 5 clouds failed; the first: " + cloud(1)), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("pointskin: warning: " + cloud(3)), std::string::npos) << result.err;
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"c0.ply", "c1.ply", "c2.ply", "c3.ply", "c4.ply", "m_c0.obj",
                                                       "m_c2.obj", "m_c4.obj"}));
}

TEST_F(Each, RefusesWhatHasNoMeaning) {
  const auto refuse = [&](const std::vector<std::string>& args, const std::string& part) {
    expect_error(pointskin_run(args), 2, part);
  };
  const std::string out = folder_ / "m_{}.ply";
  refuse({"reconstruct", cloud(0), "--each", "-o", folder_ / "m.ply"}, "needs {}");
  refuse({"reconstruct", cloud(0), "--each", "-o", out, "--report", folder_ / "r.json"}, "needs {}");
  refuse({"reconstruct", "--each", "-o", out}, "no input");
  refuse({"reconstruct", cloud(0), "--each"}, "no output");
  refuse({"reconstruct", "-", "--each", "-o", out}, "stdin");
  refuse({"reconstruct", cloud(0), cloud(0), "--each", "-o", out}, "would be the mesh of both");
  refuse({"reconstruct", cloud(0), "--each", "-o", folder_ / "{}_{}.ply"}, "twice");
  expect_error(pointskin_run({"reconstruct", cloud(0), "--each", "-o", folder_ / "none/{}.ply"}), 8, "none");
  refuse({"reconstruct", cloud(0), "--each", "-o", out, "--max-memory", "1G"}, "--each and --max-memory");
  refuse({"reconstruct", cloud(0), "--each", "-o", folder_ / "{}.ply"}, "would overwrite the input");
  refuse({"reconstruct", cloud(0), "--each", "-o", folder_ / "m_{}.txt"}, "m_c0.txt");
  for (const char* other : {"--dry-run", "--verbose"})
    refuse({"reconstruct", cloud(0), "--each", "-o", out, other}, std::string("--each and ") + other);
  refuse({"reconstruct", cloud(0), "--each", "-o", out, "--repeat", "3"}, "--each and --repeat");
  EXPECT_EQ(folder_.names().size(), kClouds);
}

TEST_F(Each, MayReplaceItsOwnInput) {
  const Result result = pointskin_run(
      {"reconstruct", cloud(0), cloud(1), "--each", "--overwrite", "-o", folder_ / "{}.ply", "--depth", "4"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(read_file(cloud(1)).find("element face"), std::string::npos);
}

}  // namespace
}  // namespace pointskin::test
