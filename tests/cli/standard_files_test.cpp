// stdin, stdout and stderr that the caller has closed: nothing that is written takes their place.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

class StandardFiles : public testing::Test {
 protected:
  StandardFiles() {
    std::vector<Sample> samples = sphere(600);
    samples.push_back({{1, 2, 3}, {0, 0, 0}});  // to be warned about
    write_file(folder_ / "scan.ply", ply_bytes(samples));
    expected_ = made_by("");
  }

  /// The mesh that a run makes whose descriptors the shell treats like this.
  std::string made_by(const std::string& redirections) {
    std::filesystem::remove(folder_ / "out.ply");
    const Result result = run_shell(
        "exec \"$P\" reconstruct scan.ply -o out.ply --report r.json --depth 3 " + redirections, folder_.path());
    EXPECT_EQ(result.exit_code, 0) << redirections << result.err;
    return read_file(folder_ / "out.ply");
  }

  TemporaryFolder folder_;
  std::string expected_;
};

TEST_F(StandardFiles, WarningsDoNotLandInOutputs) {
  ASSERT_TRUE(expected_.starts_with("ply\n"));
  for (const char* closed : {"2>&-", "0<&- 2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-", "0<&-", "1>&-"}) {
    EXPECT_EQ(made_by(closed), expected_) << closed;
    const std::string report = read_file(folder_ / "r.json");
    EXPECT_TRUE(report.starts_with("{") && report.ends_with("}\n")) << closed << report.substr(0, 200);
  }
}

/// While some frames are written, others are warned about: without a stderr the warnings would go to the files.
TEST_F(StandardFiles, WarningsOfSomeFramesDoNotLandInOthers) {
  constexpr int kFrames = 16;
  for (int frame = 10; frame < 10 + kFrames; ++frame) {
    std::vector<Sample> samples = sphere(900 + frame);
    samples.push_back({{NAN, 0, 0}, {0, 0, 1}});
    write_file(folder_ / ("p_" + std::to_string(frame) + ".ply"), ply_bytes(samples, false));
  }
  const std::string fluid = "exec \"$P\" fluid 'p_{}.ply' -r 0.06 --device cpu --at-once 4 --threads 4 -q ";
  const Result open = run_shell(fluid + "-o 'open_{}.ply'", folder_.path());
  ASSERT_EQ(std::count(open.err.begin(), open.err.end(), '\n'), kFrames) << open.err;
  for (const std::string closed : {"2>&-", "0<&- 1>&- 2>&-"}) {
    ASSERT_EQ(run_shell(fluid + "-o 'closed_{}.ply' " + closed, folder_.path()).exit_code, 0);
    for (int frame = 10; frame < 10 + kFrames; ++frame) {
      const std::string number = std::to_string(frame) + ".ply";
      EXPECT_TRUE(read_file(folder_ / ("closed_" + number)) == read_file(folder_ / ("open_" + number))) << number;
    }
  }
}

TEST_F(StandardFiles, WritingToAClosedStdoutIsAnError) {
  for (const char* closed : {">&-", "0<&- >&-"}) {
    const std::string end = closed;
    const Result mesh = run_shell("exec \"$P\" reconstruct scan.ply -o - --depth 3 " + end, folder_.path());
    expect_error(mesh, 8, "stdout");
    EXPECT_EQ(run_shell("exec \"$P\" info scan.ply " + end, folder_.path()).exit_code, 8);
    EXPECT_EQ(run_shell("exec \"$P\" convert scan.ply - " + end, folder_.path()).exit_code, 8);
    EXPECT_EQ(run_shell("exec \"$P\" --help " + end, folder_.path()).exit_code, 8);
  }
}

TEST_F(StandardFiles, ReadingAClosedStdinIsAnError) {
  for (const char* closed : {"<&-", "<&- >&-"})
    expect_error(run_shell(std::string("exec \"$P\" reconstruct - -o out.ply ") + closed, folder_.path()), 3, "stdin");
}

}  // namespace
}  // namespace pointskin::test
