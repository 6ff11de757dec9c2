// Depth, trim and small pieces: what the program finds out, says, and does when it is asked to.
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

const double kPi = std::acos(-1.0);

std::vector<Sample> scaled(std::vector<Sample> samples, float factor, const Vec3f& centre) {
  for (Sample& s : samples)
    s.position = {centre.x + factor * s.position.x, centre.y + factor * s.position.y, centre.z + factor * s.position.z};
  return samples;
}

std::vector<Sample> operator+(std::vector<Sample> a, const std::vector<Sample>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The part of a unit sphere below z = 0.2: an open scan of area 2 pi 1.2.
std::vector<Sample> bowl(int count) {
  std::vector<Sample> samples = sphere(count);
  samples.erase(std::remove_if(samples.begin(), samples.end(), [](const Sample& s) { return s.position.z > 0.2F; }),
                samples.end());
  return samples;
}

class Suggested : public testing::Test {
 protected:
  std::string save(const std::string& name, const std::vector<Sample>& samples) {
    write_file(folder_ / name, ply_bytes(samples));
    return folder_ / name;
  }

  /// `reconstruct INPUT -o out.ply --report report.json` and `more`.
  Result reconstruct(const std::string& input, const Args& more = {}) {
    std::filesystem::remove(output_);
    Args args = {"reconstruct", input, "-o", output_, "--report", folder_ / "report.json"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  Json report_of(const Result& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Json report = Json::parse(read_file(folder_ / "report.json"));
    const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json"));
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
    return report;
  }

  /// What a run of `input` with `more` writes, quietly; expects `warnings` of them.
  std::string bytes_of(const std::string& input, Args more, int warnings = 0) {
    more.push_back("-q");
    const Result result = reconstruct(input, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), warnings) << result.err;
    return read_file(output_);
  }

  void expect_usage(const std::string& input, const Args& more, const std::string& part) {
    const Result result = reconstruct(input, more);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(more) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "out.ply";
};

/// Of `count` even samples of a unit sphere in a cube of side 2.2, with cells of 0.87 spacings.
int depth_of_sphere(int count) {
  return static_cast<int>(std::lround(std::log2(2.2 / std::sqrt(0.75 * 4 * kPi / count))));
}

TEST_F(Suggested, AutomaticDepthFollowsTheDensity) {
  for (const int count : {2000, 30'000}) {
    const std::string input = save("sphere.ply", sphere(count));
    const Result result = reconstruct(input, {"--depth", "auto"});
    const int depth = depth_of_sphere(count);  // 5 and 7
    const Json report = report_of(result);
    EXPECT_EQ(report["octree"]["depth"], depth);
    EXPECT_EQ(report["options"]["depth"], depth);
    EXPECT_NE(result.err.find("depth " + std::to_string(depth) + ": the points lie"), std::string::npos) << result.err;
    EXPECT_TRUE(read_file(output_) == bytes_of(input, {"--depth", std::to_string(depth)}));
  }
}

TEST_F(Suggested, AutomaticDepthKeepsWithinTheMemoryThatIsAllowed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  const std::string input = save("sphere.ply", sphere(60'000));
  const auto dry = [&](const std::string& depth, const Args& more = {}) {
    Args args = {"reconstruct", input, "--dry-run", "--device", "cpu", "--depth", depth};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  };
  // Between what two depths take, nearer to the lower one: a process varies, and a little more is let pass.
  for (const int depth : {5, 6}) {
    const std::int64_t fits = bytes_after("with the cloud", dry(std::to_string(depth)).out);
    const std::int64_t next = bytes_after("with the cloud", dry(std::to_string(depth + 1)).out);
    ASSERT_GT(next, fits);
    const std::int64_t limit = fits + (next - fits) / 4;
    const Result result =
        reconstruct(input, {"--depth", "auto", "--device", "cpu", "--max-memory", std::to_string(limit)});
    const Json report = report_of(result);
    EXPECT_EQ(report["octree"]["depth"], depth);
    EXPECT_NE(report["warnings"].dump().find("the points hold detail for depth 7"), std::string::npos) << result.err;
  }
}

TEST_F(Suggested, TheDefaultDepthIsWarnedAboutAndAChosenOneIsNot) {
  // 0.025 apart in a cube of side 24: cells of 0.87 spacings are those of depth 10.1.
  const std::string input = save("sphere.ply", sphere(20'000));
  const Args wide = {"-q", "--scale", "12"};
  const Result warned = reconstruct(input, wide);
  EXPECT_NE(warned.err.find("hold detail for depth 10, depth 8 shows cells of 0.09"), std::string::npos) << warned.err;
  EXPECT_NE(report_of(warned)["warnings"].dump().find("use --depth 10, or --depth auto"), std::string::npos);
  for (const Args& chosen : {Args{"--depth", "8"}, Args{"--width", "0.1"}}) {
    const Result result = reconstruct(input, {wide[0], wide[1], wide[2], chosen[0], chosen[1]});
    EXPECT_EQ(report_of(result)["octree"]["depth"], 8);
    EXPECT_EQ(result.err, "");
  }
  EXPECT_EQ(reconstruct(input, {"-q"}).err, "");
}

TEST_F(Suggested, WrongDepthsAndTrimsAreUsageErrors) {
  const std::string input = save("sphere.ply", sphere(500));
  for (const std::string wrong : {"0", "21", "-1", "5.5", "automatic", "nan", ""})
    expect_usage(input, {"--depth", wrong}, "--depth");
  for (const std::string wrong : {"1", "-0.1", "automatic", "nan", ""})
    expect_usage(input, {"--trim", wrong}, "--trim");
}

TEST_F(Suggested, InfoTellsTheDepth) {
  const std::string input = save("sphere.ply", sphere(30'000));
  const Json info = Json::parse(pointskin_run({"info", input, "--json"}).out);
  const Json& suggestion = info["suggestion"];
  EXPECT_EQ(suggestion["depth"], 7);
  EXPECT_EQ(suggestion["supported"], 7);
  const double spacing = std::sqrt(4 * kPi / 30'000);
  EXPECT_NEAR(suggestion["spacing"].get<double>(), spacing, 0.15 * spacing);
  EXPECT_LT(suggestion["noise"].get<double>(), 0.1 * spacing);
  EXPECT_NE(pointskin_run({"info", input}).out.find("\ndepth       7 suits (surface points 0.0"), std::string::npos);

  write_file(folder_ / "one.xyz", "1 2 3\n1 2 3\n1 2 3\n");
  const Json one = Json::parse(pointskin_run({"info", folder_ / "one.xyz", "--json"}).out);
  EXPECT_EQ(one["suggestion"], Json(nullptr));
  write_file(folder_ / "mesh.ply", cube_mesh_ply(3));
  EXPECT_FALSE(Json::parse(pointskin_run({"info", folder_ / "mesh.ply", "--json"}).out).contains("suggestion"));
}

TEST_F(Suggested, AutomaticTrimCutsAnOpenScanAndSaysItsValue) {
  const std::string input = save("bowl.ply", bowl(30'000));
  const Result result = reconstruct(input, {"--depth", "7", "--trim", "auto"});
  const Json report = report_of(result);
  EXPECT_EQ(report["warnings"], Json::array());
  const double value = report["trim"]["quantile"].get<double>();
  EXPECT_TRUE(value == 0.01 || value == 0.02 || value == 0.05) << value;
  EXPECT_EQ(report["options"]["trim"], value);
  EXPECT_GT(report["trim"]["area_removed"].get<double>(), 0.5);
  EXPECT_NE(result.err.find("(--trim 0.0" + std::to_string(static_cast<int>(std::lround(100 * value))) + ")"),
            std::string::npos)
      << result.err;
  const Mesh mesh = read_mesh(output_);
  const MeshReport shape = measure(mesh);
  EXPECT_FALSE(shape.closed());
  EXPECT_TRUE(shape.manifold());
  EXPECT_EQ(shape.components, 1);
  const double beyond = 4 * std::sqrt(4 * kPi / 30'000);  // the border is two or three samples beyond the last
  for (const Vec3f& v : mesh.vertices) ASSERT_LT(v.z, 0.2 + beyond);
  EXPECT_GT(shape.area, 2 * kPi * 1.2);
  EXPECT_LT(shape.area, 2 * kPi * (1.2 + beyond));
}

TEST_F(Suggested, TheDefaultOnAnOpenScanNamesTheShareAndTheTrimThatCutsIt) {
  const std::string input = save("bowl.ply", bowl(30'000));
  const Result closed = reconstruct(input, {"--depth", "7", "-q"});
  EXPECT_TRUE(measure(read_mesh(output_)).closed());
  const std::size_t at = closed.err.find("--trim 0.0");
  ASSERT_NE(at, std::string::npos) << closed.err;
  EXPECT_NE(closed.err.find("% of the surface's area is farther than"), std::string::npos) << closed.err;
  const std::string value = closed.err.substr(at + 7, 4);
  const Result trimmed = reconstruct(input, {"--depth", "7", "-q", "--trim", value});
  EXPECT_EQ(trimmed.err, "");
  const Json trim = report_of(trimmed)["trim"];
  // What is said to be far goes, and so does a rim between the border and there.
  const std::size_t share_at = closed.err.rfind(' ', closed.err.find(" % of the surface's area") - 1);
  const double share = std::stod(closed.err.substr(share_at)) / 100;
  const double far = std::stod(closed.err.substr(closed.err.find("farther than ") + 13));
  const double before = trim["area_before"].get<double>();
  const double removed = trim["area_removed"].get<double>();
  EXPECT_GT(share, 0.15);
  EXPECT_GT(removed, (share - 0.01) * before);
  EXPECT_LT(removed, (share + 0.01) * before + 2 * kPi * 2 * far);  // cells as wide as `far`, and those beside them
}

TEST_F(Suggested, AutomaticTrimLeavesAClosedScanAlone) {
  const std::string input = save("sphere.ply", sphere(20'000));
  const Result result = reconstruct(input, {"--depth", "6", "--trim", "auto"});
  const Json report = report_of(result);
  EXPECT_EQ(report["trim"]["quantile"], 0);
  EXPECT_EQ(report["options"]["trim"], 0);
  EXPECT_NE(result.err.find("nothing to trim"), std::string::npos) << result.err;
  EXPECT_TRUE(read_file(output_) == bytes_of(input, {"--depth", "6"}));
}

class SmallPieces : public Suggested {
 protected:
  /// Balls of radius 1, 0.4 and 0.1: 0.855, 0.137 and 0.0085 of the area.
  SmallPieces() {
    save("balls.ply",
         sphere(20'000) + scaled(sphere(3200), 0.4F, {1.8F, 0, 0}) + scaled(sphere(400), 0.1F, {1.8F, 0.8F, 0}));
  }

  Json report_with(Args more) {
    more.insert(more.begin(), {"--depth", "7", "-q"});
    const Result result = reconstruct(folder_ / "balls.ply", more);
    EXPECT_EQ(result.err, "");
    return report_of(result);
  }
};

TEST_F(SmallPieces, OnlyTheLargestStays) {
  ASSERT_EQ(report_with({})["mesh"]["components"], 3);
  EXPECT_FALSE(report_with({}).contains("pieces"));
  const Json report = report_with({"--largest"});
  EXPECT_EQ(report["mesh"]["components"], 1);
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_EQ(report["pieces"]["pieces"], 3);
  EXPECT_EQ(report["pieces"]["pieces_removed"], 2);
  EXPECT_EQ(report["options"]["largest"], true);
  EXPECT_NEAR(measure(read_mesh(output_)).volume, 4 * kPi / 3, 0.02);
}

TEST_F(SmallPieces, GoByTrianglesOrByShareOfTheArea) {
  const auto all = report_with({})["mesh"]["triangles"].get<std::int64_t>();
  const auto left = [&](const std::string& least) {
    const Json report = report_with({"--min-component", least});
    EXPECT_EQ(report["mesh"]["triangles"], all - report["pieces"]["triangles_removed"].get<std::int64_t>());
    return report["mesh"]["components"].get<int>();
  };
  EXPECT_EQ(left("0.001"), 3);
  EXPECT_EQ(left("0.05"), 2);
  EXPECT_EQ(left("0.3"), 1);
  EXPECT_EQ(left("1"), 3);
  EXPECT_EQ(left(std::to_string(all / 30)), 2);  // 0.033 of the triangles
  EXPECT_EQ(left(std::to_string(all / 2)), 1);
}

TEST_F(SmallPieces, WrongLimitsAreUsageErrorsAndNothingLeftAnEmptyResult) {
  for (const std::string wrong : {"-1", "1.5", "nan", "inf", "big"})
    expect_usage(folder_ / "balls.ply", {"--min-component", wrong}, "--min-component");
  const Result nothing = reconstruct(folder_ / "balls.ply", {"--depth", "5", "--min-component", "1000000"});
  EXPECT_EQ(nothing.exit_code, 5);
  EXPECT_TRUE(is_one_error_line(nothing.err)) << nothing.err;
  EXPECT_NE(nothing.err.find("min-component"), std::string::npos) << nothing.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
}

}  // namespace
}  // namespace pointskin::test
