// Signals, closed pipes, kills and terminals.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using std::chrono::milliseconds;

TEST(Interrupt, WhileReadingStdinEndsWith130) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    Start start;
    start.args = {"reconstruct", "-", "-o", folder / "out.ply"};
    start.input = "ply\nformat ascii 1.0\n";
    start.keep_stdin_open = true;
    start.signal = signal;
    start.signal_after = milliseconds(300);
    start.signal_once_read = true;
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_EQ(folder.names(), std::vector<std::string>{});
  }
}

/// Wherever the signal falls: 130 and no file, or done and a whole file.
TEST(Interrupt, WhileWorkingLeavesNothingBehind) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(100000)));
  Start start;
  start.args = {"reconstruct", folder / "in.ply", "-o", folder / "out.ply", "--depth", "9", "-q"};
  const Result whole = run_program(start);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::string expected = read_file(folder / "out.ply");
  int interrupted = 0;
  for (int step = 1; step <= 8; ++step) {
    std::filesystem::remove(folder / "out.ply");
    start.signal = SIGINT;
    start.signal_after = milliseconds(static_cast<int>(whole.seconds * 1000 * step / 9));
    const Result result = run_program(start);
    interrupted += result.exit_code == 130 ? 1 : 0;
    ASSERT_TRUE(result.exit_code == 130 || result.exit_code == 0) << result.exit_code << " " << result.signal;
    const std::vector<std::string> left =
        result.exit_code == 0 ? std::vector<std::string>{"in.ply", "out.ply"} : std::vector<std::string>{"in.ply"};
    EXPECT_EQ(folder.names(), left);
    if (result.exit_code == 0) {
      EXPECT_EQ(read_file(folder / "out.ply"), expected);
    }
  }
  EXPECT_GT(interrupted, 0);
}

/// The last file is there: what remains is a line for people.
TEST(Interrupt, ChangesNothingOnceAllIsWritten) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(30000)));
  write_file(folder / "script.json", R"({"version": 1, "operations": []})");
  Start start;
  start.args = {"edit",     folder / "in.ply",
                "--script", folder / "script.json",
                "-o",       folder / "out.ply",
                "--report", folder / "report.json",
                "--depth",  "9"};
  start.signal = SIGINT;
  start.signal_once_written = folder / "report.json";
  const Result result = run_program(start);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"in.ply", "out.ply", "report.json", "script.json"}));
}

/// Nobody writes to the pipe, or reads from it: the program waits when the signal comes.
TEST(Interrupt, IsHeardWhileAPipeIsWaitedFor) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(3000)));
  ASSERT_EQ(mkfifo((folder / "p_1.ply").c_str(), 0600), 0);
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"fluid", folder / "p_1.ply", "-o", folder / "out.ply", "-r", "0.1"},
           {"fluid", folder / "p_{}.ply", "-o", folder / "out_{}.ply", "-r", "0.1"},
           {"reconstruct", folder / "p_1.ply", "-o", folder / "out.ply"},
           {"reconstruct", folder / "in.ply", "-o", folder / "p_1.ply", "--depth", "4"}}) {
    Start start;
    start.args = args;
    start.signal = SIGTERM;
    start.signal_after = milliseconds(2000);
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 130) << args[0] << result.signal << result.err;
    EXPECT_FALSE(result.timed_out);
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"in.ply", "p_1.ply"}));
  }
}

/// One step of these takes far longer than the bound, which is many times what it takes to hear the signal.
TEST(Interrupt, IsHeardWithinAStep) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(200000)));
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--field", "distance", "--depth", "11"}, {"--depth", "11", "--iterations", "1000"}}) {
    Start start;
    start.args = {"reconstruct", folder / "in.ply", "-o", folder / "out.ply", "--threads", "1", "--device", "cpu"};
    start.args.insert(start.args.end(), more.begin(), more.end());
    start.signal = SIGINT;
    start.signal_after = milliseconds(4000);
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 130) << result.signal << result.err;
    EXPECT_LT(result.seconds, 4 + 10 * kSlowdown);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"in.ply"});
  }
}

TEST(ClosedPipe, IsOutputNotWritten) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(3000)));
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"reconstruct", folder / "in.ply", "-o", "-", "--depth", "4"}, {"info", folder / "in.ply"}, {"--help"}}) {
    Start start;
    start.args = args;
    start.close_stdout = true;
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 8) << result.signal << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  }
}

TEST(FullDisk, IsOutputNotWritten) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(3000)));
  const Result result = pointskin_run({"reconstruct", folder / "in.ply", "-o", "/dev/full", "--depth", "4"});
  EXPECT_EQ(result.exit_code, 8) << result.err;
}

/// The kill falls anywhere between start and end: the file is the old one or the new one, never half of it.
TEST(KillNine, LeavesTheOldFileOrTheNewOne) {
  const TemporaryFolder folder;
  write_file(folder / "mesh.ply", cube_mesh_ply(150));
  Start start;
  start.args = {"convert", folder / "mesh.ply", folder / "out.obj", "-q"};
  ASSERT_EQ(run_program(start).exit_code, 0);
  const std::string fresh = read_file(folder / "out.obj");
  const double seconds = run_program(start).seconds;
  ASSERT_GT(fresh.size(), 1000000U);
  int killed = 0;
  for (int step = 1; step <= 25; ++step) {
    write_file(folder / "out.obj", "the old file");
    start.signal = SIGKILL;
    start.signal_after = milliseconds(static_cast<int>(seconds * 1000 * step / 25));
    killed += run_program(start).signal == SIGKILL ? 1 : 0;
    const std::string now = read_file(folder / "out.obj");
    ASSERT_TRUE(now == "the old file" || now == fresh) << now.size() << " bytes after step " << step;
  }
  EXPECT_GT(killed, 0);
}

TEST(Terminal, ColoursTheNameInErrorsUnlessNoColorIsSet) {
  Start start;
  start.args = {"info", "missing.ply"};
  start.terminal = true;
  start.environment = {"TERM=xterm", "NO_COLOR="};
  EXPECT_NE(run_program(start).err.find("\x1b[1;31m"), std::string::npos);
  start.environment = {"TERM=xterm", "NO_COLOR=1"};
  EXPECT_EQ(run_program(start).err.find('\x1b'), std::string::npos);
  start.terminal = false;
  start.environment = {"TERM=xterm"};
  EXPECT_EQ(run_program(start).err.find('\x1b'), std::string::npos);
}

TEST(Terminal, ShowsProgressForLongWorkOnlyAndNeverElsewhere) {
  const TemporaryFolder folder;
  write_file(folder / "in.ply", ply_bytes(sphere(400000)));
  Start start;
  start.args = {"reconstruct", folder / "in.ply", "-o", folder / "out.ply", "--depth", "9"};
  const Result plain = run_program(start);
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(plain.err.find('%'), std::string::npos) << plain.err;
  EXPECT_EQ(plain.err.find('\r'), std::string::npos) << plain.err;
  start.terminal = true;
  start.environment = {"TERM=xterm", "NO_COLOR=1"};
  const Result shown = run_program(start);
  if (plain.seconds > 3) {
    EXPECT_NE(shown.err.find(" %"), std::string::npos) << shown.err;
  }
  if (shown.seconds < 1) {
    EXPECT_EQ(shown.err.find(" %"), std::string::npos) << shown.err;
  }
  start.args.push_back("-q");
  EXPECT_EQ(run_program(start).err, "");
}

}  // namespace
}  // namespace pointskin::test
