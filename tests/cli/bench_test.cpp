// bench: the table, the report, the plot, and other programs beside ours.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

class BenchCommand : public testing::Test {
 protected:
  /// Runs a small bench on the CPU, and `more`.
  static Result bench(const Args& more) {
    Args args = {"bench", "--devices", "cpu", "--threads", "1", "--repeat", "3"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// The report of bench() with `more`, checked against its schema.
  Json report_of(Args more, int exit_code = 0) {
    more.insert(more.end(), {"--report", folder_ / "report.json"});
    const Result result = bench(more);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    const Json report = Json::parse(read_file(folder_ / "report.json"));
    const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/bench.schema.json"));
    EXPECT_EQ(schema_violations(schema, report), std::vector<std::string>{});
    return report;
  }

  /// A shell script that can be run.
  std::string script(const std::string& body) {
    const std::string path = folder_ / "peer's program";
    write_file(path, "#!/bin/sh\n" + body);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

  TemporaryFolder folder_;
};

const Args kSmall = {"--generate", "knot:3000", "--depths", "5,6"};

Args small_with(const Args& more) {
  Args args = kSmall;
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

TEST_F(BenchCommand, PrintsARowForEveryCloudAndDepth) {
  const Result result = bench(small_with({"--generate", "plate:2000"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 1 + 2 * 2) << result.out;
  for (const char* part : {"points", "depth", "triangles", "octree", "function", "surface", "total ms", "memory",
                           "frames/s", "knot:3000", "plate:2000", " 3000 ", " 2000 "}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part << result.out;
  }
  EXPECT_NE(result.err.find("cpu: CPU, 1 thread"), std::string::npos) << result.err;
}

TEST_F(BenchCommand, ReportsEveryPhaseOfFilesWithTheirPoints) {
  std::vector<Sample> samples = sphere(3000);
  samples[7].normal = {};
  write_file(folder_ / "sphere.ply", ply_bytes(samples));
  const Json report = report_of({folder_ / "sphere.ply", "--depths", "5,7,5"});
  EXPECT_EQ(report["clouds"].size(), 1U);
  EXPECT_EQ(report["clouds"][0]["points"], 2999);
  EXPECT_EQ(report["clouds"][0]["dropped"], 1);
  EXPECT_EQ(report["clouds"][0]["path"], folder_ / "sphere.ply");
  ASSERT_EQ(report["runs"].size(), 2U);
  for (const Json& run : report["runs"]) {
    EXPECT_EQ(run["repeat"], 3);
    for (const auto& [phase, ms] : run["ms"].items()) {
      EXPECT_LE(ms["min"].get<double>(), ms["median"].get<double>()) << phase;
      EXPECT_LE(ms["median"].get<double>(), ms["max"].get<double>()) << phase;
      EXPECT_LE(ms["min"].get<double>(), run["ms"]["total"]["max"].get<double>()) << phase;
    }
    EXPECT_NEAR(run["frames_per_second"].get<double>() * run["ms"]["total"]["median"].get<double>(), 1000, 1e-6);
  }
  EXPECT_LT(report["runs"][0]["triangles"].get<int>(), report["runs"][1]["triangles"].get<int>());
  EXPECT_EQ(report["command_line"][1], "bench");
}

TEST_F(BenchCommand, SaysInOneLineThatAFileCannotBeRead) {
  const Result result = bench({folder_ / "none.ply"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_F(BenchCommand, TellsFilesOfTheSameNameApart) {
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directory(folder_ / name);
    write_file(folder_ / name + "/scan.ply", ply_bytes(sphere(500)));
  }
  write_file(folder_ / "other.ply", ply_bytes(sphere(600)));
  const Json report =
      report_of({folder_ / "a/scan.ply", folder_ / "b/scan.ply", folder_ / "other.ply", "--depths", "4"});
  EXPECT_EQ(report["runs"][0]["cloud"], folder_ / "a/scan.ply");
  EXPECT_EQ(report["runs"][1]["cloud"], folder_ / "b/scan.ply");
  EXPECT_EQ(report["runs"][2]["cloud"], "other.ply");
}

TEST_F(BenchCommand, PlotsOnAWhiteGround) {
  const Result result = bench(small_with({"--plot", folder_ / "plot.svg"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string svg = read_file(folder_ / "plot.svg");
  EXPECT_TRUE(svg.starts_with("<svg ")) << svg.substr(0, 100);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  for (const char* part :
       {"#ffffff", "Time against points", "Time against depth", "cpu in memory, depth 5", "cpu in memory, knot:3000"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  const auto count = [&](const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(part); at != std::string::npos; at = svg.find(part, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<g "), count("</g>"));
  EXPECT_EQ(count("<text "), count("</text>"));
}

TEST_F(BenchCommand, RunsAPeerInTurnOnTheSameFile) {
  const std::string log = folder_ / "calls";
  const std::string peer = script("echo \"$# $3 $4\" >> '" + log + "'; cp \"$1\" \"$2\"; sleep 0.2\n");
  const Json report =
      report_of(small_with({"--peer", '"' + peer + "\" {in} {out} {depth} 'two words'", "--peer-repeat", "2"}));
  EXPECT_EQ(read_file(log), "4 5 two words\n4 5 two words\n4 6 two words\n4 6 two words\n");
  ASSERT_EQ(report["file_runs"].size(), 4U);
  for (std::size_t i = 0; i < 4; i += 2) {
    const Json &ours = report["file_runs"][i], &theirs = report["file_runs"][i + 1];
    EXPECT_EQ(ours["program"], "pointskin cpu");
    EXPECT_EQ(theirs["program"], "peer's program");
    EXPECT_EQ(theirs["repeat"], 2);
    EXPECT_GE(theirs["seconds"]["min"].get<double>(), 0.2);
    EXPECT_EQ(theirs["speed_up"], 1.0);
    EXPECT_NEAR(ours["speed_up"].get<double>(),
                theirs["seconds"]["median"].get<double>() / ours["seconds"]["median"].get<double>(), 1e-9);
    // A shell with cp and sleep is small, also when started by a program that is not.
    EXPECT_LT(theirs["peak_bytes"].get<double>(), ours["peak_bytes"].get<double>());
  }
}

TEST_F(BenchCommand, LeavesNothingInTheTemporaryFolder) {
  std::filesystem::create_directory(folder_ / "tmp");
  const std::string peer = script("cp \"$1\" \"$2\"\n");
  Start start;
  start.args = {"bench", "--devices", "cpu", "--repeat", "1", "--generate", "knot:3000", "--depths", "5"};
  start.args.insert(start.args.end(), {"--peer", '"' + peer + "\" {in} {out}"});
  start.environment = {"TMPDIR=" + folder_ / "tmp"};
  const Result result = run_program(start);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
}

TEST_F(BenchCommand, ReportsAPeerThatFailsAndGoesOn) {
  const std::string peer = script("echo some words; echo 'no such surface' >&2; exit 3\n");
  const Json report = report_of(small_with({"--peer", '"' + peer + "\" {in} {out}"}), 5);
  ASSERT_EQ(report["file_runs"].size(), 4U);
  EXPECT_EQ(report["file_runs"][1]["failure"], "exit status 3: no such surface");
  EXPECT_FALSE(report["file_runs"][1].contains("seconds"));
  EXPECT_FALSE(report["file_runs"][0].contains("speed_up"));
  EXPECT_EQ(report["file_runs"][2]["repeat"], 3);
  const Result people = bench(small_with({"--peer", '"' + peer + "\" {in} {out}"}));
  EXPECT_NE(people.out.find("failed: exit status 3: no such surface"), std::string::npos) << people.out;
}

TEST_F(BenchCommand, APeerWithoutAMeshOrEndedByASignalHasFailed) {
  const Json silent = report_of(small_with({"--peer", "true {in} {out}"}), 5);
  EXPECT_EQ(silent["file_runs"][1]["failure"], "exit status 0, but there is no mesh");
  const Json killed = report_of(small_with({"--peer", '"' + script("kill -9 $$\n") + "\" {in} {out}"}), 5);
  EXPECT_EQ(killed["file_runs"][1]["failure"], "signal 9 (Killed)");
}

TEST_F(BenchCommand, APeerGetsNoShell) {
  const std::string touched = folder_ / "touched";
  const Result result =
      bench(small_with({"--peer", "true {in} {out} ; touch " + touched + " $(touch " + touched + ")"}));
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_FALSE(std::filesystem::exists(touched));
}

TEST_F(BenchCommand, AnInterruptLeavesNothingBehind) {
  const std::string id = folder_ / "id";
  std::filesystem::create_directory(folder_ / "tmp");
  Start start;
  start.args = {"bench", "--devices", "cpu", "--repeat", "1", "--generate", "knot:3000", "--depths", "5"};
  start.args.insert(start.args.end(),
                    {"--peer", '"' + script("sleep 50 & echo $! > '" + id + "'; wait\n") + "\" {in} {out}"});
  start.args.insert(start.args.end(), {"--report", folder_ / "r.json"});
  start.environment = {"TMPDIR=" + folder_ / "tmp"};
  start.signal = SIGINT;
  start.signal_once_written = id;
  const Result result = run_program(start);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_LT(result.seconds, 40);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r.json"));
  // What the peer started is gone too. Nobody may have waited for it yet: then its command line is empty.
  std::string sleeper = read_file(id);
  ASSERT_FALSE(sleeper.empty()) << result.err;
  sleeper.pop_back();
  const std::string command = "/proc/" + sleeper + "/cmdline";
  EXPECT_TRUE(!std::filesystem::exists(command) || read_file(command).empty()) << read_file(command);
}

TEST_F(BenchCommand, UsageErrorsAreFoundBeforeAnyWork) {
  const std::vector<Args> wrong = {
      {"--depths", "8,"},
      {"--depths", "8,x"},
      {"--depths", "0"},
      {"--depths", "21"},
      {"--depths", "8.5"},
      {"--depths", ""},
      {"--repeat", "0"},
      {"--peer-repeat", "0"},
      {"--threads", "-1"},
      {"--devices", "cpu,gpu"},
      {"--generate", "cow:100"},
      {"--generate", "knot"},
      {"--generate", "knot:0"},
      {"--report", "-"},
      {"--plot", ""},
      {"-"},
      {"--peer", "no-such-program-anywhere {in} {out}"},
      {"--peer", "/no/such/program {in} {out}"},
      {"--peer", "cp {in}"},
      {"--peer", "cp {in} {out} {size}"},
      {"--peer", "cp '{in} {out}"},
  };
  for (const Args& more : wrong) {
    const Result result = bench(more);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(more) << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_EQ(result.out, "") << testing::PrintToString(more);
  }
}

TEST_F(BenchCommand, OutputsAreCheckedBeforeAnyWork) {
  const Result result = bench({"--generate", "knot:3000", "--report", folder_ / "no/such/folder.json"});
  EXPECT_EQ(result.exit_code, 8) << result.err;
  EXPECT_EQ(result.out, "");
  write_file(folder_ / "in.ply", ply_bytes(sphere(100)));
  EXPECT_EQ(bench({folder_ / "in.ply", "--plot", folder_ / "in.ply"}).exit_code, 2);
  EXPECT_EQ(bench({folder_ / "missing.ply", "--depths", "5"}).exit_code, 3);
}

}  // namespace
}  // namespace pointskin::test
