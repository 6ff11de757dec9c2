// Reconstructions that work: outputs, reports, names of PoissonRecon, determinism.
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

class ReconstructCommand : public testing::Test {
 protected:
  ReconstructCommand() { write_file(input_, ply_bytes(sphere(3000))); }

  /// Runs `reconstruct INPUT -o out.ply --depth 5` and `more`.
  Result reconstruct(const Args& more = {}) {
    Args args = {"reconstruct", input_, "-o", output_, "--depth", "5"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// The same with `args` alone; @returns the bytes of `output`.
  std::string bytes_of(const Args& args, const std::string& output) {
    std::filesystem::remove(output);
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(args) << result.err;
    EXPECT_EQ(result.out, "");
    return read_file(output);
  }

  std::string bytes_with(Args more) {
    more.insert(more.begin(), {"reconstruct", input_, "-o", output_, "-q"});
    return bytes_of(more, output_);
  }

  Json report_with(Args more) {
    more.insert(more.end(), {"--report", folder_ / "report.json"});
    const Result result = reconstruct(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(read_file(folder_ / "report.json"));
  }

  TemporaryFolder folder_;
  std::string input_ = folder_ / "sphere.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(ReconstructCommand, MakesAWatertightSphere) {
  const Result result = reconstruct();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const MeshReport report = measure(read_mesh(output_));
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.euler, 2);
  EXPECT_EQ(report.components, 1);
  EXPECT_NEAR(report.volume, 4.0 / 3.0 * std::acos(-1.0), 0.1);
  EXPECT_EQ(pointskin_run({"check", output_}).exit_code, 0);
}

TEST_F(ReconstructCommand, SaysOneSummaryLineOnStderrAndNothingWhenQuiet) {
  const Result loud = reconstruct();
  EXPECT_EQ(loud.out, "");
  EXPECT_EQ(std::count(loud.err.begin(), loud.err.end(), '\n'), 1) << loud.err;
  for (const char* part : {"points 3000", "depth 5", "triangles", "octree", "function", "surface", "total", "memory"}) {
    EXPECT_NE(loud.err.find(part), std::string::npos) << part << loud.err;
  }
  EXPECT_EQ(reconstruct({"-q"}).err, "");
}

TEST_F(ReconstructCommand, VerboseAddsTheLevels) {
  const Result result = reconstruct({"-v"});
  EXPECT_NE(result.err.find("residual"), std::string::npos) << result.err;
  EXPECT_GE(std::count(result.err.begin(), result.err.end(), '\n'), 8) << result.err;
}

TEST_F(ReconstructCommand, ReplacesTheOldFileAndLeavesNothingElse) {
  write_file(output_, "old");
  EXPECT_EQ(reconstruct().exit_code, 0);
  EXPECT_TRUE(read_file(output_).starts_with("ply\n"));
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"out.ply", "sphere.ply"}));
}

TEST_F(ReconstructCommand, WritesPlyToStdoutAndReadsStdin) {
  ASSERT_EQ(reconstruct().exit_code, 0);
  Start start;
  start.args = {"reconstruct", "-", "-o", "-", "--depth", "5"};
  start.input = read_file(input_);
  start.folder = folder_.path();
  const Result piped = run_program(start);
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_EQ(piped.out, read_file(output_));
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"out.ply", "sphere.ply"}));
}

TEST_F(ReconstructCommand, WritesObjAndStlOfTheSameMesh) {
  ASSERT_EQ(reconstruct().exit_code, 0);
  const std::size_t triangles = read_mesh(output_).triangles.size();
  for (const char* name : {"out.obj", "out.stl", "out.OBJ"}) {
    output_ = folder_ / name;
    ASSERT_EQ(reconstruct().exit_code, 0) << name;
    EXPECT_EQ(read_mesh(output_).triangles.size(), triangles) << name;
  }
}

TEST_F(ReconstructCommand, WritesToTheNullDevice) {
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", "/dev/null", "--depth", "4"}).exit_code, 0);
}

TEST_F(ReconstructCommand, GivesTheSameBytesForAnyThreadCountAndOrderOfPoints) {
  const std::string expected = bytes_with({"--depth", "6", "--threads", "1"});
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(bytes_with({"--depth", "6", "--threads", "2"}), expected);
  EXPECT_EQ(bytes_with({"--depth", "6", "--threads", "16"}), expected);
  for (const std::uint32_t seed : {1U, 2U}) {
    write_file(input_, ply_bytes(shuffled(sphere(3000), seed)));
    EXPECT_EQ(bytes_with({"--depth", "6"}), expected) << "seed " << seed;
  }
}

TEST_F(ReconstructCommand, MergesSeveralInputs) {
  const std::vector<Sample> all = sphere(3000);
  write_file(folder_ / "a.ply", ply_bytes({all.begin(), all.begin() + 1000}));
  write_file(folder_ / "b.ply", ply_bytes({all.begin() + 1000, all.end()}));
  const Args args = {"reconstruct", folder_ / "a.ply", folder_ / "b.ply", "-o", output_, "--depth", "5", "-q"};
  EXPECT_EQ(bytes_of(args, output_), bytes_with({"--depth", "5"}));
}

TEST_F(ReconstructCommand, RefusesToMergeACloudWithoutNormals) {
  write_file(folder_ / "bare.ply", ply_bytes(sphere(10), false));
  const Result result = pointskin_run({"reconstruct", input_, folder_ / "bare.ply", "-o", output_});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("bare.ply"), std::string::npos) << result.err;
}

TEST_F(ReconstructCommand, AcceptsTheNamesOfPoissonRecon) {
  const std::string expected = bytes_with({"--depth", "5"});
  EXPECT_EQ(bytes_of({"reconstruct", "--in", input_, "--out", output_, "--depth", "5", "--pointWeight", "2",
                      "--samplesPerNode", "1.5", "--scale", "1.1", "--threads", "2", "-q"},
                     output_),
            expected);
  EXPECT_EQ(bytes_with({"--depth", "5", "--pointWeight", "0"}), bytes_with({"--depth", "5", "--screening", "0"}));
  EXPECT_EQ(bytes_with({"--depth", "5", "--samplesPerNode", "3"}),
            bytes_with({"--depth", "5", "--samples-per-node", "3"}));
  EXPECT_NE(bytes_with({"--depth", "5", "--pointWeight", "0"}), expected);
  EXPECT_EQ(bytes_with({"--depth", "5", "--confidence", "0"}), expected);
  EXPECT_EQ(bytes_with({"--depth", "5", "--confidence", "1"}), bytes_with({"--depth", "5", "--confidence"}));
}

TEST_F(ReconstructCommand, MergesInputsNamedInBothWays) {
  EXPECT_EQ(bytes_of({"reconstruct", input_, "--in", input_, "-o", output_, "--depth", "4", "-q"}, output_),
            bytes_of({"reconstruct", input_, input_, "-o", output_, "--depth", "4", "-q"}, output_));
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "--in", input_ + ".missing", "-o", output_}).exit_code, 3);
}

TEST_F(ReconstructCommand, NeverOverwritesAnInputWithTheReport) {
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", output_, "--report", input_}).exit_code, 2);
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", output_, "--report", ""}).exit_code, 2);
  EXPECT_EQ(pointskin_run({"info", input_}).exit_code, 0) << "the input is still there";
  EXPECT_EQ(pointskin_run({"check", input_}).exit_code, 3) << "a cloud is no mesh";
}

/// The sphere is 2 wide and the cube 2.2: cells of depth 5 are 0.06875 wide.
TEST_F(ReconstructCommand, WidthChoosesTheDepthWhoseCellsAreNotWider) {
  const std::string expected = bytes_with({"--depth", "5"});
  EXPECT_EQ(bytes_with({"--width", "0.07"}), expected);
  EXPECT_EQ(bytes_with({"--width", "0.13"}), expected);
  EXPECT_EQ(bytes_with({"--width", "0.14"}), bytes_with({"--depth", "4"}));
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", output_, "--width", "1e-9"}).exit_code, 2);
}

TEST_F(ReconstructCommand, DensityAndNormalsAreProperties) {
  ASSERT_EQ(reconstruct({"--density"}).exit_code, 0);
  const Mesh rich = read_mesh(output_);
  ASSERT_EQ(rich.attributes.size(), 1U);
  EXPECT_EQ(rich.attributes[0].name, "density");
  EXPECT_EQ(rich.normals.size(), rich.vertices.size());
  ASSERT_EQ(reconstruct({"--no-normals"}).exit_code, 0);
  EXPECT_TRUE(read_mesh(output_).normals.empty());
}

TEST_F(ReconstructCommand, OpenLeavesAHalfSphereOpenAndClosedDoesNot) {
  std::vector<Sample> half = sphere(4000);
  std::erase_if(half, [](const Sample& s) { return s.position.z > 0; });
  write_file(input_, ply_bytes(half));
  ASSERT_EQ(reconstruct().exit_code, 0);
  EXPECT_TRUE(measure(read_mesh(output_)).watertight());
  const Result open = reconstruct({"--open"});
  EXPECT_EQ(open.exit_code, 0) << open.err;
}

TEST_F(ReconstructCommand, TrimCutsAHalfSphereOpenAndReportsIt) {
  std::vector<Sample> half = sphere(20'000);
  std::erase_if(half, [](const Sample& s) { return s.position.z > 0; });
  write_file(input_, ply_bytes(half));
  EXPECT_FALSE(report_with({}).contains("trim"));
  const Json report = report_with({"--trim", "0.3", "--island-ratio", "0.002"});
  EXPECT_EQ(schema_violations(Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json")), report),
            std::vector<std::string>{});
  EXPECT_EQ(report["options"]["trim"], 0.3);
  EXPECT_EQ(report["options"]["island_ratio"], 0.002);
  EXPECT_FALSE(report["mesh"]["closed"]);
  EXPECT_TRUE(report["mesh"]["manifold"]);
  EXPECT_EQ(report["mesh"]["euler"], 1);
  EXPECT_GT(report["trim"]["triangles_removed"], 0);
  const MeshReport mesh = measure(read_mesh(output_));
  EXPECT_NEAR(mesh.area, 2 * std::acos(-1.0), 0.6);
  EXPECT_NEAR(mesh.area, report["trim"]["area_before"].get<double>() - report["trim"]["area_removed"].get<double>(),
              1e-3);
  EXPECT_EQ(pointskin_run({"check", output_}).exit_code, 5) << "it is not watertight";
  EXPECT_NE(reconstruct({"--trim", "0.3"}).err.find("trimmed"), std::string::npos);
}

TEST_F(ReconstructCommand, TrimLeavesAClosedSphereAndChecksItsRange) {
  EXPECT_EQ(bytes_with({"--depth", "5", "--trim", "0.01"}), bytes_with({"--depth", "5"}));
  for (const char* option : {"--trim", "--island-ratio"})
    for (const char* bad : {"1", "-0.1", "nan", "much"})
      EXPECT_EQ(pointskin_run({"reconstruct", input_, "-o", output_, option, bad}).exit_code, 2) << option << bad;
}

/// A spot with most of the points, which is too small to stay.
TEST_F(ReconstructCommand, TrimmingAllAwayIsAnEmptyResult) {
  std::vector<Sample> samples = sphere(5000);
  const std::vector<Sample> fine = sphere(400'000);
  for (const Sample& s : fine)
    if (s.position.z > 0.99)
      for (int copy = 0; copy < 10; ++copy) samples.push_back(s);
  write_file(input_, ply_bytes(samples));
  std::filesystem::remove(output_);
  const Result result = reconstruct({"--trim", "0.9", "--island-ratio", "0.2"});
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_NE(result.err.find("trim"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(ReconstructCommand, LinearFitCanBeSwitched) {
  const std::string expected = bytes_with({"--depth", "5"});
  EXPECT_EQ(bytes_with({"--depth", "5", "--linear-fit", "off"}), expected);
  EXPECT_EQ(bytes_with({"--depth", "5", "--linear-fit", "on"}), bytes_with({"--depth", "5", "--linear-fit"}));
}

TEST_F(ReconstructCommand, DryRunPrintsTheEstimateAndWritesNothing) {
  const Result result = reconstruct({"--dry-run", "--report", folder_ / "report.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE((result.out + result.err).find("estimate"), std::string::npos);
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"sphere.ply"}));
  EXPECT_EQ(pointskin_run({"reconstruct", input_, "--dry-run"}).exit_code, 0);
  const Result to_stdout = pointskin_run({"reconstruct", input_, "-o", "-", "--dry-run"});
  EXPECT_EQ(to_stdout.exit_code, 0);
  EXPECT_EQ(to_stdout.out, "");
}

TEST_F(ReconstructCommand, DryRunPrintsThePeakThatTheReportMeasures) {
  const std::int64_t estimate = bytes_after("estimate", reconstruct({"--dry-run"}).out);
  const std::string report = folder_ / "report.json";
  ASSERT_EQ(reconstruct({"--report", report}).exit_code, 0);
  const double peak = Json::parse(read_file(report))["memory"]["device_peak_bytes"].get<double>();
  EXPECT_NEAR(static_cast<double>(estimate), peak, 0.15 * peak);
}

TEST_F(ReconstructCommand, TheLimitIsTheEstimateWithTheCloud) {
  const Args on_cpu = {"--device", "cpu"};  // a GPU's memory does not hold the cloud
  const auto with = [&](Args more) {
    more.insert(more.end(), on_cpu.begin(), on_cpu.end());
    return reconstruct(more);
  };
  const std::int64_t estimate = bytes_after("with the cloud", with({"--dry-run"}).out);
  ASSERT_GT(estimate, 0);
  // The process is never twice of exactly the same size: a fiftieth more, or 1 MiB, is let pass.
  const std::string less = std::to_string(estimate * 3 / 4);
  EXPECT_EQ(with({"--max-memory", std::to_string(estimate)}).exit_code, 0);
  EXPECT_EQ(with({"--max-memory", less}).exit_code, 6);
  EXPECT_EQ(with({"--dry-run", "--max-memory", less}).exit_code, 6);
}

TEST_F(ReconstructCommand, EnoughMemoryIsEnough) { EXPECT_EQ(reconstruct({"--max-memory", "64G"}).exit_code, 0); }

TEST_F(ReconstructCommand, ReportFollowsItsSchema) {
  const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/report.schema.json"));
  for (const Args& more :
       {Args{}, Args{"--repeat", "3"}, Args{"--density", "--open", "--shift", "none", "--keep-attributes"}}) {
    const Json report = report_with(more);
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
    EXPECT_EQ(report.contains("ms_repeat"), !more.empty() && more[0] == "--repeat");
  }
}

TEST_F(ReconstructCommand, ReportTellsWhatTheFileHolds) {
  const Json report = report_with({"--iterations", "4"});
  const MeshReport mesh = measure(read_mesh(output_));
  EXPECT_EQ(report["mesh"]["vertices"], mesh.vertices);
  EXPECT_EQ(report["mesh"]["triangles"], mesh.triangles);
  EXPECT_EQ(report["mesh"]["euler"], 2);
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_EQ(report["mesh"]["manifold"], true);
  EXPECT_EQ(report["input"], (Json{{"points", 3000},
                                   {"used", 3000},
                                   {"dropped", 0},
                                   {"normals", "kept"},
                                   {"strays", {{"count", 0}, {"points", Json::array()}}}}));
  EXPECT_EQ(report["warnings"], Json::array());
  EXPECT_EQ(report["options"]["depth"], 5);
  EXPECT_EQ(report["options"]["iterations"], 4);
  EXPECT_EQ(report["octree"]["depth"], 5);
  EXPECT_EQ(report["octree"]["levels"].size(), 6U);
  EXPECT_GT(report["isovalue"].get<double>(), 0.2);
  EXPECT_LT(report["isovalue"].get<double>(), 0.8);
  EXPECT_GT(report["memory"]["host_peak_bytes"].get<std::int64_t>(), 1 << 20);
  EXPECT_GT(report["memory"]["device_peak_bytes"].get<std::int64_t>(), 0);
}

TEST_F(ReconstructCommand, ReportsResidualsThatShrink) {
  const Json report = report_with({});
  const Json& last = report["solve"]["levels"].back();
  EXPECT_GT(last["residual_before"].get<double>(), 0);
  EXPECT_LT(last["residual_after"].get<double>(), last["residual_before"].get<double>());
}

TEST_F(ReconstructCommand, ReportTimesAddUpToAtMostTheTotal) {
  const Json ms = report_with({})["ms"];
  double sum = 0;
  for (const auto& [key, value] : ms.items()) sum += key == "total" ? 0 : value.get<double>();
  EXPECT_LE(sum, ms["total"].get<double>() * 1.01 + 1);
}

TEST_F(ReconstructCommand, ReportsFileNamesThatAreNoUtf8) {
  output_ = folder_ / "caf\xe9.ply";
  const Json report = report_with({});
  EXPECT_NE(report["options"]["output"].get<std::string>().find("caf"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(output_));
}

TEST_F(ReconstructCommand, RepeatNeedsNoOutputAndReportsFramesPerSecond) {
  const Result result =
      pointskin_run({"reconstruct", input_, "--depth", "4", "--repeat", "3", "--report", folder_ / "r.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("frames per second"), std::string::npos) << result.err;
  const Json ms = Json::parse(read_file(folder_ / "r.json"))["ms_repeat"];
  EXPECT_LE(ms["min"].get<double>(), ms["median"].get<double>());
  EXPECT_LE(ms["median"].get<double>(), ms["max"].get<double>());
}

TEST_F(ReconstructCommand, TakesTheBoundaryByNameAndByPoissonReconsNumber) {
  const std::string free = bytes_with({});
  EXPECT_EQ(bytes_with({"--boundary", "free"}), free);
  EXPECT_EQ(bytes_with({"--boundary", "neumann"}), free);
  EXPECT_EQ(bytes_with({"--bType", "1"}), free);
  EXPECT_EQ(bytes_with({"--bType", "3"}), free);
  const std::string dirichlet = bytes_with({"--boundary", "dirichlet"});
  EXPECT_NE(dirichlet, free);
  EXPECT_EQ(bytes_with({"--bType", "2"}), dirichlet);
  EXPECT_EQ(report_with({})["options"]["boundary"], "free");
  EXPECT_EQ(report_with({"--boundary", "dirichlet"})["options"]["boundary"], "dirichlet");
  for (const Args& wrong :
       {Args{"--boundary", "robin"}, Args{"--bType", "4"}, Args{"--bType", "2", "--boundary", "free"}})
    EXPECT_EQ(reconstruct(wrong).exit_code, 2) << wrong[1];
}

TEST_F(ReconstructCommand, KeepsSurveyCoordinates) {
  std::string text;
  for (const Sample& s : sphere(3000)) {
    const auto number = [&text](double v) { text += std::to_string(v) + " "; };
    number(500000.25 + s.position.x);
    number(4100000.5 + s.position.y);
    number(100 + s.position.z);
    number(s.normal.x);
    number(s.normal.y);
    number(s.normal.z);
    text += "\n";
  }
  write_file(folder_ / "survey.xyz", text);
  ASSERT_EQ(pointskin_run({"reconstruct", folder_ / "survey.xyz", "-o", output_, "--depth", "5"}).exit_code, 0);
  const MeshReport report = measure(read_mesh(output_));
  EXPECT_NEAR(report.volume, 4.0 / 3.0 * std::acos(-1.0), 0.1);
  const Mesh mesh = read_mesh(output_);
  const Bounds box = bounds_of(mesh.vertices);
  EXPECT_NEAR(mesh.origin[1] + box.lower.y, 4100000.5 - 1, 0.05);
  EXPECT_NEAR(mesh.origin[0] + box.upper.x, 500000.25 + 1, 0.05);
}

}  // namespace
}  // namespace pointskin::test
