// Memory of the process: what is said of it, and what --max-memory makes of it.
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

class ProcessMemory : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  }

  Result run(const std::string& cloud, const std::string& depth, const Args& more) {
    Args args = {"reconstruct", cloud, "-o", output_, "--depth", depth, "--device", "cpu", "--threads", "2"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// Largest size of the process that reconstructs, by its own report.
  std::int64_t peak(const std::string& cloud, const std::string& depth, Args more = {}) {
    more.insert(more.end(), {"--report", report_});
    const Result result = run(cloud, depth, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(read_file(report_))["memory"]["host_peak_bytes"].get<std::int64_t>();
  }

  std::string write(const Cloud& cloud, const std::string& name) {
    write_cloud(folder_ / name, cloud);
    return folder_ / name;
  }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "mesh.ply";
  std::string report_ = folder_ / "report.json";
};

TEST_F(ProcessMemory, OfAGuideWithFarTooManyPointsIsNotAskedFor) {
  const std::string cloud = write(sphere_cloud(60, 1), "cloud.ply");
  const std::string script = folder_ / "ops.json";
  write_file(script, R"({"version": 1, "operations": [{"op": "guide", "camera": {"azimuth": 0, "elevation": 0},
    "area": [[[100, 100], [900, 100], [900, 700], [100, 700]]], "interval": 0.002, "inside_only": false}]})");
  const Result result = pointskin_run(
      {"edit", cloud, "--script", script, "-o", output_, "--device", "cpu", "--max-memory", "400M", "--depth", "6"});
  expect_error(result, 6, "--max-memory");
  EXPECT_NE(result.err.find("interval"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(ProcessMemory, OfEditAndDeformIsLimited) {
  const std::string cloud = write(sphere_cloud(20'000, 1), "cloud.ply");
  const std::string ops = folder_ / "ops.json";
  write_file(ops, R"({"version": 1, "operations": []})");
  const std::string bend = folder_ / "bend.json";
  write_file(bend, R"({"handles": [{"region": {"half_space": {"point": [0, 0, 0], "normal": [0, -1, 0]}},
    "rigid": {"translation": [0, -0.1, 0]}}]})");
  for (const auto& [command, script] : {std::pair{"edit", ops}, std::pair{"deform", bend}}) {
    Args args = {command, cloud, "--script", script, "-o", output_, "--device", "cpu", "--depth", "8", "-q"};
    args.insert(args.end(), {"--max-memory", "24M"});
    expect_error(pointskin_run(args), 6, "--max-memory");
    args.back() = "8G";
    EXPECT_EQ(pointskin_run(args).exit_code, 0) << command;
  }
}

TEST_F(ProcessMemory, IsWhatTheDryRunSaysWithin5PercentFrom64MiBOn) {
  struct Case {
    Cloud cloud;
    const char* depth;
  };
  for (const Case& one : {Case{torus_cloud(300'000, 1), "8"}, Case{torus_cloud(100'000, 1), "9"},
                          Case{sphere_cloud(400'000, 2), "8"}, Case{sphere_cloud(800'000, 3), "6"}}) {
    const std::string cloud = write(one.cloud, "cloud.ply");
    const auto said = static_cast<double>(bytes_after("with the cloud", run(cloud, one.depth, {"--dry-run"}).out));
    const auto taken = static_cast<double>(peak(cloud, one.depth));
    ASSERT_GT(taken, 64 << 20) << "too small a case";
    EXPECT_NEAR(said / taken, 1, 0.05) << one.cloud.size() << " points, depth " << one.depth;
  }
}

TEST_F(ProcessMemory, StaysBelowTheLimitWhateverIsAllowed) {
  const std::string cloud = write(sphere_cloud(200'000, 4), "cloud.ply");
  const std::int64_t needed = peak(cloud, "8");
  const std::string whole = read_file(output_);
  for (const double share : {0.8, 0.9}) {  // in blocks
    const auto limit = static_cast<std::int64_t>(share * static_cast<double>(needed));
    std::filesystem::remove(output_);
    EXPECT_LE(peak(cloud, "8", {"--max-memory", std::to_string(limit)}), limit + limit / 20) << share;
    EXPECT_TRUE(read_file(output_) == whole) << share;
  }
  std::filesystem::remove(output_);
  const Result refused = run(cloud, "8", {"--max-memory", std::to_string(needed / 5)});
  EXPECT_EQ(refused.exit_code, 6);
  EXPECT_NE(refused.err.find("--max-memory"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
  for (const double share : {1.05, 1.3}) {
    const auto limit = static_cast<std::int64_t>(share * static_cast<double>(needed));
    EXPECT_LE(peak(cloud, "8", {"--max-memory", std::to_string(limit)}), limit + limit / 20) << share;
  }
}

TEST_F(ProcessMemory, OfTextAndPipesStaysBelowTheLimit) {
  const Cloud points = sphere_cloud(200'000, 5);
  write(points, "cloud.ply");
  std::ostringstream text;
  text.precision(9);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3f &p = points.positions[i], &n = points.normals[i];
    text << p.x << ' ' << p.y << ' ' << p.z << ' ' << n.x << ' ' << n.y << ' ' << n.z << '\n';
  }
  write_file(folder_ / "cloud.xyz", text.str());
  const std::int64_t limit = peak(folder_ / "cloud.ply", "8") * 4 / 5;
  const std::string whole = read_file(output_);
  const std::string work =
      "-o mesh.ply --report report.json --depth 8 --device cpu --threads 2 --temp . --max-memory " +
      std::to_string(limit);
  for (const std::string from :
       {R"("$P" reconstruct cloud.xyz )", R"("$P" reconstruct - < cloud.xyz )",
        R"(cat cloud.ply | "$P" reconstruct - )", R"(mkfifo pipe; cat cloud.ply > pipe & "$P" reconstruct pipe )"}) {
    SCOPED_TRACE(from);
    std::filesystem::remove(output_);
    std::filesystem::remove(folder_ / "pipe");
    const std::size_t words = from.find('<');
    const Result result = run_shell(
        words == std::string::npos ? from + work : from.substr(0, words) + work + from.substr(words), folder_ / "");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find(" blocks"), std::string::npos) << result.err;
    EXPECT_TRUE(read_file(output_) == whole);
    EXPECT_LE(nlohmann::json::parse(read_file(report_))["memory"]["host_peak_bytes"].get<std::int64_t>(),
              limit + limit / 20);
  }
  expect_error(run_shell(R"(cat cloud.ply | "$P" reconstruct - -o mesh.ply --depth 8 --max-memory 1G --temp /proc)",
                         folder_ / ""),
               8, "--temp");
}

TEST_F(ProcessMemory, OfBlocksIsSaidByTheDryRun) {
  const std::string cloud = write(sphere_cloud(200'000, 7), "cloud.ply");
  const std::int64_t needed = peak(cloud, "8");
  std::filesystem::remove(output_);
  const std::string limit = std::to_string(needed * 4 / 5);
  const Result said = run(cloud, "8", {"--max-memory", limit, "--dry-run"});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.out.find("blocks, each with"), std::string::npos) << said.out;
  EXPECT_FALSE(std::filesystem::exists(output_));
  const Result refused = run(cloud, "8", {"--max-memory", limit, "--dry-run", "--weakness"});
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_EQ(run(cloud, "8", {"--max-memory", "20M", "--dry-run"}).exit_code, 6);
}

TEST_F(ProcessMemory, IsWhatSplitMakesBlocksFor) {
  const std::string cloud = write(sphere_cloud(20'000, 8), "cloud.ply");
  const std::string first = folder_ / "mesh_0000.ply";
  const Result result = run(cloud, "7", {"--max-memory", "2G", "--split"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("1 block in 1 file"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
  ASSERT_TRUE(std::filesystem::exists(first));
  EXPECT_EQ(run(cloud, "7", {}).exit_code, 0);
  EXPECT_EQ(read_mesh(first).triangles.size(), read_mesh(output_).triangles.size());  // the whole, as it fits
  expect_error(run(cloud, "7", {"--split"}), 2, "--split needs --max-memory");
  expect_error(run(cloud, "5", {"--max-memory", "2G", "--split"}), 2, "a depth of at least 7");
  expect_error(run(cloud, "7", {"--max-memory", "2G", "--split", "--report", folder_ / "r.json"}), 2, "--report");
  const std::string alike = write(sphere_cloud(2'000, 9), "mesh_0003.ply");
  expect_error(run(alike, "7", {"--max-memory", "2G", "--split"}), 2, "may write this file");
}

TEST_F(ProcessMemory, TooSmallForAWholeIsNoReasonToIgnoreWhatBlocksCannotDo) {
  const std::string cloud = write(sphere_cloud(400'000, 6), "cloud.ply");  // too large to be read within the limit
  write_mesh(folder_ / "box.ply", box_mesh({-2, -2, -2}, {2, 2, 2}));
  for (const Args& asked :
       {Args{"--envelope", folder_ / "box.ply"}, Args{"--normals", "estimate"}, Args{"--weakness"}}) {
    Args args = {"--max-memory", "30M", "-q"};
    args.insert(args.end(), asked.begin(), asked.end());
    expect_error(run(cloud, "8", args), 2, "in blocks there is not yet");
    EXPECT_FALSE(std::filesystem::exists(output_)) << asked.front();
  }
}

TEST_F(ProcessMemory, OfAutomaticDepthStaysBelowTheLimit) {
  const std::string cloud = write(sphere_cloud(200'000, 5), "cloud.ply");
  constexpr std::int64_t kLimit = 96 << 20;
  EXPECT_LE(peak(cloud, "auto", {"--max-memory", "96M"}), kLimit + kLimit / 20);
}

}  // namespace
}  // namespace pointskin::test
