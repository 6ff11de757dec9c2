// pointskin studio as a person starts it.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <memory>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"
#include "studio/server/raw_client.hpp"
#include "studio/server/running_server.hpp"

namespace pointskin::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

const std::regex kOneLine(R"(http://127\.0\.0\.1:[0-9]+/#[0-9a-f]{32}\n)");

class StudioCommand : public testing::Test {
 protected:
  StudioCommand() {
    std::string form = (fs::temp_directory_path() / "pointskin-studio-XXXXXX").string();
    folder_ = mkdtemp(form.data());
  }
  ~StudioCommand() override { fs::remove_all(folder_); }

  /// The command with these options, which gets a signal after a while.
  [[nodiscard]] Start start(const std::vector<std::string>& options, int signal = SIGTERM) const {
    Start start;
    start.args = {"studio", "--device", "cpu"};
    start.args.insert(start.args.end(), options.begin(), options.end());
    start.environment = {"XDG_STATE_HOME=" + folder_.string(), "DISPLAY=", "WAYLAND_DISPLAY="};
    start.folder = folder_;
    start.signal = signal;
    start.signal_after = 1500ms * kSlowdown;
    return start;
  }

  /// A port that was free a moment ago.
  static std::string free_port() { return std::to_string(RunningServer().port()); }

  fs::path folder_;
};

TEST_F(StudioCommand, PrintsItsAddressAndEndsWithASignal) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const Result result = run_program(start({"--no-browser"}, signal));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(std::regex_match(result.out, kOneLine)) << result.out;
    EXPECT_EQ(result.err, "");
  }
}

TEST_F(StudioCommand, TellsPagesThatItCloses) {
  const std::string port = free_port();
  auto running = std::async(std::launch::async, [&] { return run_program(start({"--no-browser", "--port", port})); });
  std::unique_ptr<RawClient> page;
  for (int i = 0; i < 100 && page == nullptr; ++i) {
    try {
      page = std::make_unique<RawClient>(std::stoi(port));
    } catch (const std::runtime_error&) {
      std::this_thread::sleep_for(10ms);
    }
  }
  ASSERT_NE(page, nullptr);
  const std::string host = "Host: 127.0.0.1:" + port + "\r\n";
  const Reply index = page->ask("GET / HTTP/1.1\r\n" + host + "\r\n");
  EXPECT_EQ(index.status, 200);
  EXPECT_NE(index.body.find("<!doctype html>"), std::string::npos);
  EXPECT_EQ(page->ask("GET /blob/1 HTTP/1.1\r\n" + host + "\r\n").status, 401);
  EXPECT_TRUE(page->closed_after(5s * kSlowdown).has_value());
  EXPECT_EQ(running.get().exit_code, 0);
}

TEST_F(StudioCommand, APortThatIsTakenIsOneLine) {
  const RunningServer other;
  expect_error(run_program(start({"--no-browser", "--port", std::to_string(other.port())}, 0)), 8, "is taken");
}

TEST_F(StudioCommand, WhatCannotBeIsSaidBeforeAnythingListens) {
  expect_error(run_program(start({"--port", "70000"}, 0)), 2, "--port");
  expect_error(run_program(start({"--port", "-1"}, 0)), 2, "--port");
  expect_error(run_program(start({"--host", "192.0.2.1"}, 0)), 2, "192.0.2.1");
  expect_error(run_program(start({"--max-upload", "much"}, 0)), 2, "--max-upload");
  expect_error(run_program(start({"--root", "nothing"}, 0)), 2, "nothing");
  expect_error(run_program(start({"--resume", "a.ply"}, 0)), 2, "--resume");
  expect_error(run_program(start({"nothing.ply"}, 0)), 3, "nothing.ply");
  expect_error(run_program(start({folder_.string()}, 0)), 3, "is a folder");
}

TEST_F(StudioCommand, AddressesThatOthersReachAreWarnedOf) {
  const Result result = run_program(start({"--no-browser", "--host", "0.0.0.0"}));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(std::regex_match(result.out, kOneLine)) << result.out;
  EXPECT_TRUE(result.err.starts_with("pointskin: warning: --host 0.0.0.0: ")) << result.err;
  EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  EXPECT_EQ(run_program(start({"--no-browser", "--host", "localhost"})).err, "");
}

TEST_F(StudioCommand, TheBrowserGetsASecretOfItsOwn) {
  const fs::path opened = folder_ / "opened";
  std::ofstream(folder_ / "xdg-open") << "#!/bin/sh\necho \"$1\" >'" << opened.string() << "'\n";
  fs::permissions(folder_ / "xdg-open", fs::perms::owner_all);
  Start with_display = start({});
  with_display.environment = {"XDG_STATE_HOME=" + folder_.string(), "DISPLAY=:99",
                              "PATH=" + folder_.string() + ":/usr/bin:/bin"};
  const Result result = run_program(with_display);
  EXPECT_EQ(result.exit_code, 0);
  std::ifstream stream(opened);
  const std::string url{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_TRUE(std::regex_match(url, kOneLine)) << url;
  EXPECT_NE(url, result.out) << "whoever lists processes would see the token";
  EXPECT_EQ(url.substr(0, url.find('#')), result.out.substr(0, result.out.find('#')));

  fs::remove(opened);
  with_display.args.emplace_back("--no-browser");
  EXPECT_EQ(run_program(with_display).exit_code, 0);
  EXPECT_FALSE(fs::exists(opened));
}

TEST_F(StudioCommand, NobodyToReadTheAddressIsAnError) {
  Start closed = start({"--no-browser"}, 0);
  closed.close_stdout = true;
  expect_error(run_program(closed), 8, "stdout");
}

}  // namespace
}  // namespace pointskin::test
