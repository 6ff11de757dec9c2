// What reconstruct and orient notice about normals, say, and do: on stderr, in the report, and in the mesh.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>
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

const double kBall = 4.0 / 3.0 * std::acos(-1.0);
const std::string kWarning = "pointskin: warning: ";

/// Each normal turned with this chance.
std::vector<Sample> with_flips(std::vector<Sample> samples, double share, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (Sample& s : samples)
    if (random() < share * 4294967296.0) s.normal = {-s.normal.x, -s.normal.y, -s.normal.z};
  return samples;
}

/// Points scattered about a place, normally distributed by Irwin and Hall: they are on no surface.
std::vector<Sample> mist(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&random] {
    float sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<float>(random() >> 8) * 0x1p-24F;
    return sum;
  };
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const float x = draw(), y = draw(), z = draw();
    samples.push_back({{x, y, z}, {0, 0, 1}});
  }
  return samples;
}

class WarningsCommand : public testing::Test {
 protected:
  std::string save(const std::string& name, const std::vector<Sample>& samples, bool with_normals = true) {
    write_file(folder_ / name, ply_bytes(samples, with_normals));
    return folder_ / name;
  }

  /// `reconstruct INPUT -o out.ply --depth 6 -q --report report.json` and `more`.
  Result reconstruct(const std::string& input, const Args& more = {}) {
    std::filesystem::remove(output_);
    Args args = {"reconstruct", input, "-o", output_, "--depth", "6", "-q", "--report", folder_ / "report.json"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// The report, which follows its schema and has the warnings that were printed.
  Json report_of(const Result& result, const std::string& schema = "report.schema.json") {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(read_file(folder_ / "report.json"));
    const Json rules = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/" + schema));
    EXPECT_EQ(schema_violations(rules, report), std::vector<std::string>{});
    std::string printed;
    for (const Json& warning : report["warnings"]) printed += kWarning + warning.get<std::string>() + "\n";
    EXPECT_EQ(printed, result.err);  // under -q there is nothing else
    return report;
  }

  /// Expects one warning, which holds `part`.
  static void expect_one_warning(const Result& result, const std::string& part) {
    EXPECT_TRUE(result.err.starts_with(kWarning)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }

  std::string bytes() { return read_file(output_); }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "out.ply";
};

TEST_F(WarningsCommand, HalfOfTheNormalsFlippedAreRepairedAndItIsSaid) {
  const Result result = reconstruct(save("half.ply", with_flips(sphere(8000), 0.5, 1)));
  const Json report = report_of(result);
  expect_one_warning(result, "the normals contradict each other");
  EXPECT_NE(result.err.find("--normals given"), std::string::npos) << result.err;
  EXPECT_EQ(report["input"]["normals"], "repaired");
  EXPECT_NEAR(report["normals"]["flipped"].get<double>(), 4000, 200);
  EXPECT_EQ(report["options"]["point_normals"], "auto");
  const Mesh mesh = read_mesh(output_);
  const MeshReport shape = measure(mesh);
  EXPECT_TRUE(shape.watertight());
  EXPECT_EQ(shape.components, 1);
  EXPECT_EQ(shape.euler, 2);
  for (const Vec3f& v : mesh.vertices) ASSERT_NEAR(std::hypot(v.x, v.y, v.z), 1, 0.01);
}

TEST_F(WarningsCommand, ACloudThatIsInsideOutGivesTheBytesOfTheRightOne) {
  ASSERT_EQ(reconstruct(save("right.ply", sphere(5000))).err, "");
  const std::string expected = bytes();
  const std::string inward = save("inward.ply", with_flips(sphere(5000), 1, 2));
  for (const Args& more : {Args{}, Args{"--boundary", "dirichlet"}, Args{"--open"}}) {
    const Result result = reconstruct(inward, more);
    expect_one_warning(result, "all were turned");
    EXPECT_EQ(report_of(result)["input"]["normals"], "turned");
    if (more.empty() || more[0] != "--boundary") {
      EXPECT_TRUE(bytes() == expected);
    }
    EXPECT_NEAR(measure(read_mesh(output_)).volume, kBall, 0.05);
  }
}

TEST_F(WarningsCommand, GivenNormalsStayAsTheyAreWithAWarning) {
  const std::string inward = save("inward.ply", with_flips(sphere(5000), 1, 3));
  const Result box = reconstruct(inward, {"--normals", "given"});
  expect_one_warning(box, "point into what the points enclose");
  EXPECT_EQ(report_of(box)["input"]["normals"], "kept");
  const MeshReport solid = measure(read_mesh(output_));
  EXPECT_EQ(solid.components, 2);  // the working cube, and the ball that is missing from it
  EXPECT_GT(solid.volume, 5);

  const Result walls = reconstruct(inward, {"--normals", "given", "--trim", "auto"});
  EXPECT_EQ(report_of(walls)["warnings"], Json::array());
  EXPECT_EQ(measure(read_mesh(output_)).components, 1);
  EXPECT_NEAR(measure(read_mesh(output_)).volume, -kBall, 0.05);

  const Result half = reconstruct(save("half.ply", with_flips(sphere(8000), 0.5, 4)), {"--normals", "given"});
  EXPECT_EQ(report_of(half)["input"]["normals"], "kept");
  EXPECT_NE(half.err.find("of the normals point against those around them: --normals repair"), std::string::npos)
      << half.err;
  EXPECT_FALSE(report_of(half).contains("normals"));
}

TEST_F(WarningsCommand, PointsThatAreThereTwiceWithOpposedNormalsAreNamed) {
  std::vector<Sample> twice = sphere(2000);
  const std::vector<Sample> turned = with_flips(twice, 1, 4);
  twice.insert(twice.end(), turned.begin(), turned.end());
  const std::string cloud = save("twice.ply", twice);
  for (const char* field : {"poisson", "distance"}) {
    const Result result = reconstruct(cloud, {"--normals", "given", "--field", field});
    const Json report = report_of(result);
    EXPECT_NE(result.err.find("of the normals point against those around them"), std::string::npos) << result.err;
  }
}

TEST_F(WarningsCommand, ConsistentNormalsGiveTheSameBytesWithoutAWordHoweverTheyAreTaken) {
  const std::string input = save("right.ply", sphere(5000));
  ASSERT_EQ(report_of(reconstruct(input, {"--normals", "given"}))["warnings"], Json::array());
  const std::string expected = bytes();
  for (const Args& more : {Args{}, Args{"--normals", "auto"}, Args{"--normals", "repair"}}) {
    const Json report = report_of(reconstruct(input, more));
    EXPECT_EQ(report["warnings"], Json::array());
    EXPECT_EQ(report["input"]["normals"], more.empty() || more[1] == "auto" ? "kept" : "repaired");
    EXPECT_TRUE(bytes() == expected);
  }
}

TEST_F(WarningsCommand, OneOfTwoPartsThatIsInsideOutIsTurned) {
  std::vector<Sample> samples = sphere(6000);
  for (Sample s : sphere(6000, {3, 0, 0})) {
    s.normal = {-s.normal.x, -s.normal.y, -s.normal.z};
    samples.push_back(s);
  }
  const Json report = report_of(reconstruct(save("parts.ply", samples)));
  EXPECT_EQ(report["input"]["normals"], "repaired");
  EXPECT_EQ(report["normals"]["flipped"], 6000);
  const MeshReport shape = measure(read_mesh(output_));
  EXPECT_TRUE(shape.watertight());
  EXPECT_EQ(shape.components, 2);
  EXPECT_NEAR(shape.volume, 2 * kBall, 0.1);
}

TEST_F(WarningsCommand, AnUnknownPolicyIsAUsageError) {
  const std::string input = save("right.ply", sphere(500));
  for (const std::string wrong : {"turned", "AUTO", ""}) {
    Args args = {"reconstruct", input, "-o", output_, "--normals", wrong};
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, 2) << wrong;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_NE(result.err.find("--normals"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(output_));
  }
  const Result both = pointskin_run({"reconstruct", input, "-o", output_, "--normals", "auto", "--estimate-normals"});
  EXPECT_EQ(both.exit_code, 2);
  const Result none =
      pointskin_run({"reconstruct", save("bare.ply", sphere(500), false), "-o", output_, "--normals", "repair"});
  EXPECT_EQ(none.exit_code, 4) << none.err;
  EXPECT_NE(none.err.find("--normals estimate"), std::string::npos) << none.err;
}

TEST_F(WarningsCommand, EstimateNormalsIsAnotherNameForEstimate) {
  const std::string bare = save("bare.ply", sphere(4000), false);
  ASSERT_EQ(report_of(reconstruct(bare, {"--normals", "estimate"}))["input"]["normals"], "estimated");
  const std::string expected = bytes();
  ASSERT_FALSE(expected.empty());
  for (const std::string alias : {"--estimate-normals", "--estimate-normals=auto", "--estimate-normals=propagate"}) {
    const Json report = report_of(reconstruct(bare, {alias}));
    EXPECT_EQ(report["options"]["point_normals"], "estimate");
    EXPECT_TRUE(bytes() == expected) << alias;
  }
}

TEST_F(WarningsCommand, DoubtfulNormalsAreNamedByReconstructAndOrient) {
  const std::string drops = save("mist.ply", mist(6000, 5), false);
  const std::string doubt = "of the estimated normals are doubtful";
  const Result mesh = reconstruct(drops, {"--normals", "estimate"});
  EXPECT_NE(mesh.err.find(doubt), std::string::npos) << mesh.err;
  EXPECT_NE(report_of(mesh)["warnings"].dump().find(doubt), std::string::npos);

  const Args orient = {"orient", drops, "-o", output_, "-q", "--report", folder_ / "report.json"};
  const Result normals = pointskin_run(orient);
  expect_one_warning(normals, doubt);
  const Json report = report_of(normals, "orient.schema.json");
  EXPECT_GE(report["normals"]["doubtful"].get<int>(), 3000);

  const std::string bare = save("bare.ply", sphere(4000), false);
  EXPECT_EQ(reconstruct(bare, {"--normals", "estimate"}).err, "");
  EXPECT_EQ(pointskin_run({"orient", bare, "-o", output_, "-q"}).err, "");
}

TEST_F(WarningsCommand, SignsThatDidNotSettleAreNamed) {
  const Args restless = {"--estimate-normals=iterate", "--random-start", "--max-rounds", "1"};
  const Result result = reconstruct(save("bare.ply", sphere(4000), false), restless);
  EXPECT_NE(result.err.find("had not settled"), std::string::npos) << result.err;
  EXPECT_EQ(report_of(result)["normals"]["settled"], false);
}

TEST_F(WarningsCommand, OrientTurnsACloudThatIsInsideOutUnlessItIsToRepairAlone) {
  const std::string inward = save("inward.ply", with_flips(sphere(5000), 1, 6));
  const auto orient = [&](const std::string& method) {
    const Result result =
        pointskin_run({"orient", inward, "-o", output_, "-q", "--method", method, "--report", folder_ / "report.json"});
    return report_of(result, "orient.schema.json")["normals"];
  };
  const auto outward = [&] {
    const Cloud cloud = read_cloud(output_);
    std::int64_t count = 0;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const Vec3f p = cloud.positions[i], n = cloud.normals[i];
      count += p.x * n.x + p.y * n.y + p.z * n.z > 0.99F ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(orient("auto")["flipped"], 5000);
  EXPECT_EQ(outward(), 5000);
  EXPECT_EQ(orient("repair")["kept"], 5000);
  EXPECT_EQ(outward(), 0);
}

}  // namespace
}  // namespace pointskin::test
