// Stray points and the program: the file is that of the cloud without them, and everything names them.
#include <algorithm>
#include <cmath>
#include <cstdio>
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

class StraysCommand : public testing::Test {
 protected:
  /// A sphere and strays at the places, in the middle of the file.
  std::string save(const std::vector<Vec3f>& places) {
    std::vector<Sample> samples = sphere(4000);
    for (const Vec3f& p : places) samples.insert(samples.begin() + 2000, {p, {0, 1, 0}});
    write_file(folder_ / "in.ply", ply_bytes(samples));
    return folder_ / "in.ply";
  }

  Result reconstruct(const std::string& input, const Args& more = {}) {
    Args args = {"reconstruct", input, "-o", output_, "--depth", "6"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  std::string bytes_of(const std::string& input) {
    EXPECT_EQ(reconstruct(input, {"-q"}).exit_code, 0);
    return read_file(output_);
  }

  Json report_of(const std::string& input, Args more = {}) {
    more.insert(more.end(), {"--report", folder_ / "report.json"});
    const Result result = reconstruct(input, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Json report = Json::parse(read_file(folder_ / "report.json"));
    const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json"));
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
    return report;
  }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "out.ply";
};

TEST_F(StraysCommand, OfAFileOfTheirOwnCostTheOthersNoDigits) {
  const std::string sphere = save({});
  const std::string expected = bytes_of(sphere);
  write_file(folder_ / "far.xyz", "1000000 1000000 1000000 0 0 1\n");
  for (const bool first : {false, true}) {
    Args args = {"reconstruct", sphere, "-o", output_, "--depth", "6", "-q"};
    args.insert(args.begin() + (first ? 1 : 2), folder_ / "far.xyz");
    EXPECT_EQ(pointskin_run(args).exit_code, 0);
    EXPECT_TRUE(read_file(output_) == expected) << first;
  }
}

TEST_F(StraysCommand, GiveTheFileOfTheCloudWithoutThem) {
  const std::string expected = bytes_of(save({}));
  EXPECT_EQ(bytes_of(save({{1e6F, 0, 0}})), expected);
  EXPECT_EQ(bytes_of(save({{0, -1e30F, 0}})), expected);
  EXPECT_EQ(bytes_of(save({{9, 9, 9}, {-7, 0, 0}, {0, 0, 1e4F}})), expected);
}

TEST_F(StraysCommand, AreNamedInOneWarningAndInTheReport) {
  const std::string input = save({{0, 0, 64}, {4096, 0, 0}});
  const Result result = reconstruct(input, {"-q"});
  EXPECT_EQ(result.err,
            "pointskin: warning: 2 stray points far from all others are left out, the farthest at 4096 0 0; use "
            "--keep-strays to keep them\n");
  const Json report = report_of(input);
  EXPECT_EQ(report["input"], (Json{{"points", 4002},
                                   {"used", 4000},
                                   {"dropped", 0},
                                   {"normals", "kept"},
                                   {"strays", {{"count", 2}, {"points", {{4096, 0, 0}, {0, 0, 64}}}}}}));
  EXPECT_EQ(report["options"]["keep_strays"], false);
  EXPECT_EQ("pointskin: warning: " + report["warnings"].at(0).get<std::string>() + "\n", result.err);
}

TEST_F(StraysCommand, AreListedUpToTen) {
  std::vector<Vec3f> places;
  for (int i = 0; i < 30; ++i) places.push_back({100.0F * static_cast<float>(i + 1), 0, 0});
  const Json strays = report_of(save(places))["input"]["strays"];
  EXPECT_EQ(strays["count"], 30);
  EXPECT_EQ(strays["points"].size(), 10U);
  EXPECT_EQ(strays["points"][0][0], 3000);
}

TEST_F(StraysCommand, CountWithKeepStrays) {
  const std::string input = save({{300, 0, 0}});
  EXPECT_EQ(reconstruct(input, {"-q", "--keep-strays"}).err, "");
  const Json report = report_of(input, {"--keep-strays"});
  EXPECT_EQ(report["input"]["used"], 4001);
  EXPECT_EQ(report["input"]["strays"], (Json{{"count", 0}, {"points", Json::array()}}));
  EXPECT_EQ(report["options"]["keep_strays"], true);
}

TEST_F(StraysCommand, AreNoneInAnOrdinaryCloud) {
  EXPECT_EQ(reconstruct(save({}), {"-q"}).err, "");
  EXPECT_EQ(report_of(save({}))["input"]["strays"]["count"], 0);
}

TEST_F(StraysCommand, AreNamedByInfoAndByTheDryRun) {
  const std::string input = save({{4096, 0, 0}});
  EXPECT_NE(pointskin_run({"info", input}).out.find("strays      1, the farthest at 4096 0 0\n"), std::string::npos);
  const Json info = Json::parse(pointskin_run({"info", input, "--json"}).out);
  EXPECT_EQ(info["strays"], (Json{{"count", 1}, {"points", {{4096, 0, 0}}}}));
  EXPECT_EQ(pointskin_run({"info", save({})}).out.find("strays"), std::string::npos);
  const std::string again = save({{4096, 0, 0}});
  EXPECT_NE(reconstruct(again, {"--dry-run"}).err.find("1 stray points"), std::string::npos);
  EXPECT_EQ(reconstruct(again, {"--dry-run", "--keep-strays"}).err, "");
}

TEST_F(StraysCommand, DoNotChooseTheDepthOfAWidth) {
  const auto depth_of = [&](const std::string& input) {
    const Result result = pointskin_run({"reconstruct", input, "-o", output_, "--width", "0.04"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err.substr(result.err.find("depth "), 8);
  };
  EXPECT_EQ(depth_of(save({})), "depth 6,");  // 2.2 / 64 = 0.034
  EXPECT_EQ(depth_of(save({{1e6F, 0, 0}})), "depth 6,");
}

/// Text keeps doubles: a sphere of radius 1 in survey coordinates, and what a scanner writes for "nothing".
TEST_F(StraysCommand, KeepTheMillimetresOfSurveyCoordinates) {
  std::string text;
  for (const Sample& s : sphere(4000)) {
    char line[200];
    const int length = std::snprintf(line, sizeof line, "%.6f %.6f %.6f %.6f %.6f %.6f\n", 2.6e6 + s.position.x,
                                     1.2e6 + s.position.y, 400.0 + s.position.z, s.normal.x, s.normal.y, s.normal.z);
    text.append(line, static_cast<std::size_t>(length));
  }
  for (const std::string stray : {"0 0 0 0 0 1\n", "1e12 0 0 0 0 1\n", "0 1e9 0 0 0 1\n0 0 -1e9 1 0 0\n"}) {
    SCOPED_TRACE(stray);
    write_file(folder_ / "in.xyz", text + stray);
    ASSERT_EQ(reconstruct(folder_ / "in.xyz").exit_code, 0);
    const Mesh mesh = read_mesh(output_);
    const MeshReport report = measure(mesh);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.euler, 2);
    double worst = 0;
    for (const Vec3f& v : mesh.vertices)
      worst = std::max(worst, std::abs(std::hypot(mesh.origin[0] + v.x - 2.6e6, mesh.origin[1] + v.y - 1.2e6,
                                                  mesh.origin[2] + v.z - 400) -
                                       1));
    EXPECT_LT(worst, 0.005);
  }
}

}  // namespace
}  // namespace pointskin::test
