// pointskin orient and reconstruct --estimate-normals: what they write, report and refuse.
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

class OrientCommand : public testing::Test {
 protected:
  OrientCommand() {
    write_file(bare_, ply_bytes(sphere(4000), false));
    std::vector<Sample> wrong = sphere(4000);
    for (std::size_t i = 0; i < wrong.size(); i += 4) {
      Vec3f& n = wrong[i].normal;
      n = {-n.x, -n.y, -n.z};
    }
    write_file(wrong_, ply_bytes(wrong));
  }

  Result orient(const std::string& input, const Args& more = {}) {
    Args args = {"orient", input, "-o", output_};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// Expects outward normals at all points of the output.
  void expect_outward() {
    const Cloud cloud = read_cloud(output_);
    ASSERT_EQ(cloud.size(), 4000);
    ASSERT_TRUE(cloud.has_normals());
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const Vec3f p = cloud.positions[i], n = cloud.normals[i];
      ASSERT_GT(p.x * n.x + p.y * n.y + p.z * n.z, 0.9);
    }
  }

  void expect_failure(const Result& result, int code, const std::string& part) {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  Json report_against(const std::string& schema) {
    const Json report = Json::parse(read_file(report_));
    const Json rules = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/" + schema));
    for (const std::string& violation : schema_violations(rules, report)) ADD_FAILURE() << violation;
    return report;
  }

  TemporaryFolder folder_;
  std::string bare_ = folder_ / "bare.ply";
  std::string wrong_ = folder_ / "wrong.ply";
  std::string output_ = folder_ / "out.ply";
  std::string report_ = folder_ / "report.json";
};

TEST_F(OrientCommand, GivesACloudNormals) {
  const Result result = orient(bare_, {"--report", report_});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("assumed"), std::string::npos) << result.err;
  expect_outward();
  const Json report = report_against("orient.schema.json");
  EXPECT_EQ(report["normals"]["method"], "propagate");
  EXPECT_EQ(report["normals"]["given"], 0);
  EXPECT_EQ(report["input"]["points"], 4000);
  const Cloud cloud = read_cloud(output_);
  ASSERT_EQ(cloud.attributes.size(), 1U);
  EXPECT_EQ(cloud.attributes[0].name, "confidence");
}

TEST_F(OrientCommand, CorrectsWhatIsWrong) {
  ASSERT_EQ(orient(wrong_, {"-q", "--report", report_, "--no-confidence", "--curvature"}).exit_code, 0);
  expect_outward();
  const Json report = report_against("orient.schema.json");
  EXPECT_EQ(report["normals"]["method"], "repair");
  EXPECT_EQ(report["normals"]["flipped"], 1000);
  EXPECT_EQ(report["normals"]["kept"], 3000);
  EXPECT_EQ(read_cloud(output_).attributes.at(0).name, "curvature");
}

TEST_F(OrientCommand, TurnsNormalsToTheSensor) {
  ASSERT_EQ(orient(bare_, {"-q", "--sensor", "0.1,0.2,-0.1"}).exit_code, 0);
  const Cloud cloud = read_cloud(output_);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3f p = cloud.positions[i], n = cloud.normals[i];
    ASSERT_LT(p.x * n.x + p.y * n.y + p.z * n.z, -0.9);
  }
}

TEST_F(OrientCommand, WritesTheSameBytesForAnyNumberOfThreads) {
  ASSERT_EQ(orient(bare_, {"-q", "--threads", "1"}).exit_code, 0);
  const std::string once = read_file(output_);
  ASSERT_EQ(orient(bare_, {"-q", "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(read_file(output_), once);
}

TEST_F(OrientCommand, RefusesWhatCannotBe) {
  expect_failure(orient(bare_, {"--method", "guess"}), 2, "--method");
  expect_failure(orient(bare_, {"--method", "sensor"}), 2, "sensor");
  expect_failure(orient(bare_, {"--method", "repair"}), 4, "normals");
  expect_failure(orient(bare_, {"--sensor", "1,2"}), 2, "");
  expect_failure(orient(bare_, {"--max-rounds", "0"}), 2, "max-rounds");
  expect_failure(orient(folder_ / "none.ply"), 3, "none.ply");
  expect_failure(pointskin_run({"orient", bare_, "-o", folder_ / "out.obj"}), 2, ".ply");
}

TEST_F(OrientCommand, ReconstructEstimatesWhereItIsTold) {
  const Result refused = pointskin_run({"reconstruct", bare_, "-o", output_});
  expect_failure(refused, 4, "--estimate-normals");
  for (const char* option : {"--estimate-normals", "--estimate-normals=propagate", "--estimate-normals=iterate"}) {
    const Result result =
        pointskin_run({"reconstruct", bare_, "-o", output_, "--depth", "5", option, "-q", "--report", report_});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const MeshReport mesh = measure(read_mesh(output_));
    EXPECT_TRUE(mesh.watertight());
    EXPECT_NEAR(mesh.volume, 4.18879, 0.1);
    const Json report = report_against("report.schema.json");
    EXPECT_EQ(report["normals"]["points"], 4000);
  }
  std::filesystem::remove(output_);
  expect_failure(pointskin_run({"reconstruct", bare_, "-o", output_, "--estimate-normals=guess"}), 2,
                 "--estimate-normals");
}

TEST_F(OrientCommand, ReconstructCountsTheMemoryOfNormals) {
  const auto with = [&](Args more) {
    Args args = {"reconstruct", bare_, "-o", output_, "--depth", "4", "--estimate-normals", "--device", "cpu"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  };
  const std::int64_t estimate = bytes_after("with the cloud", with({"--dry-run"}).out);
  ASSERT_GT(estimate, 0);
  EXPECT_EQ(with({"--max-memory", std::to_string(estimate), "--report", report_}).exit_code, 0);
  const Json report = report_against("report.schema.json");
  EXPECT_GE(report["memory"]["device_peak_bytes"].get<std::int64_t>(), 400 * 4000);
  EXPECT_LE(report["memory"]["device_peak_bytes"].get<std::int64_t>(), estimate);
  std::filesystem::remove(output_);
  expect_failure(with({"--max-memory", std::to_string(estimate * 3 / 4)}), 6, "--max-memory");
}

TEST_F(OrientCommand, ReconstructRepairsGivenNormals) {
  ASSERT_EQ(pointskin_run({"reconstruct", wrong_, "-o", output_, "--depth", "5", "--estimate-normals", "-q"}).exit_code,
            0);
  EXPECT_NEAR(measure(read_mesh(output_)).volume, 4.18879, 0.1);
}

}  // namespace
}  // namespace pointskin::test
