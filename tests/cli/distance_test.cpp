// --field, --offset, --weakness, problems and render --target: what the program says of them, and what it refuses.
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

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

class FieldOptions : public testing::Test {
 protected:
  FieldOptions() { write_file(input_, ply_bytes(sphere(3000))); }

  Result run(const std::string& command, const Args& more) {
    Args args = {command, input_, "-o", output_, "--depth", "5", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// The report of a run that must succeed; checked against the schema.
  Json report_of(const std::string& command, Args more) {
    more.insert(more.end(), {"--report", folder_ / "r.json"});
    const Result result = run(command, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(read_file(folder_ / "r.json"));
    const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/report.schema.json"));
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>());
    return report;
  }

  void expect_usage_error(const Args& more) {
    const Result result = run("reconstruct", more);
    EXPECT_EQ(result.exit_code, 2) << more[0] << ": " << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "sphere.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(FieldOptions, DistanceHasItsSidesFromASolve) {
  const Json report = report_of("reconstruct", {"--field", "distance"});
  EXPECT_EQ(report["options"]["field"], "distance");
  EXPECT_EQ(report["isovalue"], 0);
  EXPECT_EQ(report["solve"]["levels"].size(), 6U);
  EXPECT_EQ(report["octree"]["levels"].size(), 6U);
  EXPECT_TRUE(measure(read_mesh(output_)).watertight());
  EXPECT_EQ(report_of("reconstruct", {})["options"]["field"], "poisson");
}

TEST_F(FieldOptions, OffsetMovesTheSurfaceOutAndIn) {
  for (const std::string field : {"poisson", "distance"})
    for (const double offset : {0.3, -0.3}) {
      const Json report = report_of("reconstruct", {"--field", field, "--offset", std::to_string(offset)});
      EXPECT_NEAR(report["offset"]["distance"].get<double>(), offset, 1e-6);
      EXPECT_NEAR(report["isovalue"].get<double>(), -report["offset"]["cells"].get<double>(), 1e-9);
      const MeshReport measured = measure(read_mesh(output_));
      EXPECT_TRUE(measured.watertight());
      EXPECT_NEAR(std::cbrt(measured.volume * 3 / (4 * std::acos(-1.0))), 1 + offset, 0.02);
    }
  EXPECT_FALSE(report_of("reconstruct", {}).contains("offset"));
}

TEST_F(FieldOptions, AnOffsetThatLeavesNothingIsAnEmptyResult) {
  const Result result = run("reconstruct", {"--offset", "-1.5"});
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(FieldOptions, WhatMakesNoSenseIsAUsageError) {
  expect_usage_error({"--field", "laplace"});
  expect_usage_error({"--field", "distance", "--boundary", "dirichlet"});
  expect_usage_error({"--field", "distance", "--weakness"});
  expect_usage_error({"--offset", "nan"});
  expect_usage_error({"--offset", "0.1", "--trim", "0.05"});
  expect_usage_error({"--offset", "0.1", "--density"});
  expect_usage_error({"--offset", "0.1", "--keep-attributes"});
  expect_usage_error({"--offset", "0.1", "--open"});
  expect_usage_error({"--offset", "0.1", "--weakness"});
}

/// Half of a sphere: what closes it is a guess.
std::vector<Sample> half_sphere() {
  std::vector<Sample> samples;
  for (const Sample& s : sphere(8000))
    if (s.position.z > 0) samples.push_back(s);
  return samples;
}

TEST_F(FieldOptions, ProblemsAreListedWithViewsThatRenderUnderstands) {
  write_file(input_, ply_bytes(half_sphere()));
  const Json report = report_of("problems", {});
  EXPECT_EQ(report["command"], "problems");
  ASSERT_FALSE(report["problems"].empty());
  const Json& worst = report["problems"][0];
  EXPECT_LT(worst["centroid"][2].get<double>(), 0.1);  // where there are no points
  ASSERT_EQ(worst["views"].size(), 3U);
  const Json& view = worst["views"][0];
  EXPECT_TRUE(view["picture"].is_null());
  EXPECT_GT(view["visible"].get<double>(), 0.5);
  EXPECT_EQ(view["matrix"].size(), 16U);
  const auto number = [](const Json& v) { return std::to_string(v.get<double>()); };
  const Json& at = view["target"];
  const Result picture =
      pointskin_run({"render", output_, "-o", folder_ / "p.png", "--size", "40x30", "--azimuth",
                     number(view["azimuth"]), "--elevation", number(view["elevation"]), "--fit", "sphere", "--zoom",
                     number(view["zoom"]), "--target", number(at[0]) + "," + number(at[1]) + "," + number(at[2])});
  EXPECT_EQ(picture.exit_code, 0) << picture.err;
  const Mesh mesh = read_mesh(output_);
  ASSERT_EQ(mesh.attributes.size(), 1U);
  EXPECT_EQ(mesh.attributes[0].name, "weakness");
}

TEST_F(FieldOptions, ProblemsAreDrawnIntoAFolderThatIsMade) {
  write_file(input_, ply_bytes(half_sphere()));
  const std::string pictures = folder_ / "new/pictures";
  const Json report = report_of("problems", {"--pictures", pictures, "--up", "z"});
  EXPECT_EQ(report["options"]["pictures"], pictures);
  EXPECT_EQ(report["options"]["up"], "z");
  ASSERT_FALSE(report["problems"].empty());
  std::size_t files = 0;
  for (std::size_t r = 0; r < report["problems"].size(); ++r)
    for (std::size_t v = 0; v < report["problems"][r]["views"].size(); ++v) {
      const std::string name = pictures + "/problem_0" + std::to_string(r + 1) + "_" + std::to_string(v + 1) + ".png";
      EXPECT_EQ(report["problems"][r]["views"][v]["picture"], name);
      const std::string png = read_file(name);
      ASSERT_GT(png.size(), 1000U);
      EXPECT_EQ(png.substr(1, 3), "PNG");
      EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
      ++files;
    }
  std::size_t present = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(pictures)) ++present;
  EXPECT_EQ(present, files);
}

TEST_F(FieldOptions, ProblemsAreDrawnAsManyAsAskedFor) {
  std::vector<Sample> two = half_sphere();  // two half spheres, apart: a guess each
  for (const Sample& s : half_sphere()) two.push_back({{s.position.x + 4, s.position.y, s.position.z}, s.normal});
  write_file(input_, ply_bytes(two));
  const Json report = report_of("problems", {"--pictures", folder_ / "p", "--pictures-most", "1"});
  ASSERT_GE(report["problems"].size(), 2U);
  EXPECT_TRUE(report["problems"][0]["views"][0]["picture"].is_string());
  EXPECT_TRUE(report["problems"][1]["views"][0]["picture"].is_null());
}

TEST_F(FieldOptions, ProblemPicturesThatCannotBeWrittenAreFoundBeforeTheWork) {
  write_file(folder_ / "file", "");
  for (const std::string& folder : {folder_ / "file", folder_ / "file/in", std::string("/proc/pictures")}) {
    const Result result = pointskin_run({"problems", "missing.ply", "--pictures", folder});
    EXPECT_EQ(result.exit_code, 8) << folder << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  }
  for (const Args& wrong : {Args{"--pictures-most", "0"}, Args{"--up", "w"}}) {
    Args args = {"problems", "missing.ply"};
    args.insert(args.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(pointskin_run(args).exit_code, 2) << wrong[0];
  }
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", output_, "--pictures", folder_ / "p"}).exit_code, 2);
}

TEST_F(FieldOptions, ProblemsNeedNoOutputAndComeAsATable) {
  write_file(input_, ply_bytes(half_sphere()));
  const Result some = pointskin_run({"problems", input_, "--depth", "5", "-q"});
  EXPECT_EQ(some.exit_code, 0) << some.err;
  EXPECT_EQ(some.out.substr(0, 4), "rank");
  write_file(input_, ply_bytes(sphere(20000)));
  const Result none = pointskin_run({"problems", input_, "--depth", "5", "-q"});
  EXPECT_EQ(none.exit_code, 0) << none.err;
  EXPECT_EQ(none.out, "no region whose topology is doubtful\n");
}

TEST_F(FieldOptions, RenderRefusesATargetThatIsNoPoint) {
  ASSERT_EQ(run("reconstruct", {}).exit_code, 0);
  for (const char* wrong : {"1,2", "1,2,3,4", "a,b,c", "1,2,inf"})
    EXPECT_EQ(pointskin_run({"render", output_, "-o", folder_ / "p.png", "--target", wrong}).exit_code, 2) << wrong;
}

}  // namespace
}  // namespace pointskin::test
