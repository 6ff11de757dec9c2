// --envelope: what the program says of it, and what it refuses.
#include <algorithm>
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

/// A box around the origin as OBJ.
std::string box_obj(float half, bool closed = true) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    text += "v";
    for (int axis = 0; axis < 3; ++axis) {
      text += ' ';
      text += std::to_string((i >> axis & 1) != 0 ? half : -half);
    }
    text += "\n";
  }
  text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n";
  return text + (closed ? "f 2 4 8 6\n" : "");
}

class EnvelopeOption : public testing::Test {
 protected:
  EnvelopeOption() {
    write_file(input_, ply_bytes(sphere(3000)));
    write_file(envelope_, box_obj(0.9F));
  }

  Result reconstruct(const Args& more) {
    Args args = {"reconstruct", input_, "-o", output_, "--depth", "5", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// One line of error, this code, and no output.
  void expect_failure(const Args& more, int code, const std::string& part) {
    const Result result = reconstruct(more);
    expect_error(result, code, part);
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "sphere.ply";
  std::string envelope_ = folder_ / "box.obj";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(EnvelopeOption, KeepsTheSurfaceInsideAndReportsWhatItDid) {
  const Result result = reconstruct({"--envelope", envelope_, "--report", folder_ / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const Mesh mesh = read_mesh(output_);
  EXPECT_TRUE(measure(mesh).watertight());
  const Bounds box = bounds_of(mesh.vertices);
  EXPECT_LE(std::max({box.upper.x, box.upper.y, box.upper.z}), 0.9F + 1e-6F);
  EXPECT_GE(std::min({box.lower.x, box.lower.y, box.lower.z}), -0.9F - 1e-6F);

  const Json report = Json::parse(read_file(folder_ / "r.json"));
  const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json"));
  EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>());
  EXPECT_EQ(report["envelope"]["file"], envelope_);
  EXPECT_EQ(report["options"]["envelope"], envelope_);
  EXPECT_NEAR(report["envelope"]["samples_outside"].get<double>(), 0.3 * 3000, 30);  // six caps of height 0.1
  EXPECT_GE(report["envelope"]["vertices_moved"].get<int>(), 0);
}

TEST_F(EnvelopeOption, LeavesTheReportWithoutItAlone) {
  ASSERT_EQ(reconstruct({"--report", folder_ / "r.json"}).exit_code, 0);
  const Json report = Json::parse(read_file(folder_ / "r.json"));
  EXPECT_FALSE(report.contains("envelope"));
  EXPECT_TRUE(report["options"]["envelope"].is_null());
}

TEST_F(EnvelopeOption, RefusesWhatIsNoClosedMesh) {
  expect_failure({"--envelope", folder_ / "nowhere.ply"}, 3, "nowhere.ply");
  expect_failure({"--envelope", input_}, 3, "sphere.ply");  // a cloud
  write_file(folder_ / "open.obj", box_obj(1.5F, false));
  expect_failure({"--envelope", folder_ / "open.obj"}, 3, "not closed");
  write_file(folder_ / "empty.obj", "");
  expect_failure({"--envelope", folder_ / "empty.obj"}, 3, "empty.obj");
  expect_failure({"--envelope", ""}, 2, "--envelope");
}

TEST_F(EnvelopeOption, FailsWhereAllPointsLieOutside) {
  write_file(envelope_, box_obj(0.1F));
  expect_failure({"--envelope", envelope_}, 5, "outside of the envelope");
}

TEST_F(EnvelopeOption, NeitherSharesStdinNorIsOverwritten) {
  const Result both = pointskin_run({"reconstruct", "-", "--envelope", "-", "-o", output_});
  EXPECT_EQ(both.exit_code, 2) << both.err;
  expect_failure({"--envelope", envelope_, "--report", envelope_}, 2, "overwrite");
  EXPECT_EQ(read_file(envelope_), box_obj(0.9F));
}

TEST_F(EnvelopeOption, CountsInTheMemoryEstimate) {
  const Result without = pointskin_run({"reconstruct", input_, "--dry-run", "--depth", "5", "--device", "cpu"});
  const Result within =
      pointskin_run({"reconstruct", input_, "--dry-run", "--depth", "5", "--device", "cpu", "--envelope", envelope_});
  EXPECT_EQ(within.exit_code, 0) << within.err;
  EXPECT_NE(within.out, without.out);
  EXPECT_NE(within.out.find("with the cloud, the envelope and the program"), std::string::npos) << within.out;
}

}  // namespace
}  // namespace pointskin::test
