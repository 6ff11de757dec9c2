// What was answered is on the disk: a studio that is killed goes on where it was.
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

namespace fs = std::filesystem;

using test::guide;
using test::in_rectangle;
using test::Json;
using test::lift;
using test::pixel;
using test::StudioTest;

class SessionJournal : public StudioTest {
 protected:
  void apply(const Json& operation) { (void)page().ask("apply", {{"operation", operation}}); }
  void resume(const fs::path& journal = {}) {
    studio::StudioOptions options;
    options.resume = true;
    options.session = journal;
    start(options);
  }
};

std::vector<Json> three() {
  return {lift(0.2), guide({pixel(-0.9, 0), pixel(0.9, 0)}, 0.05),
          in_rectangle("remove", pixel(-0.9, 0.2), pixel(-0.5, -0.2))};
}

/// Works, and dies when all has been answered.
class SessionThatDies : public SessionJournal {
 protected:
  [[noreturn]] void work_and_die(const fs::path& journal) {
    studio::StudioOptions options;
    options.session = journal;
    start(options);
    open_shape();
    for (const Json& operation : three()) apply(operation);
    (void)page().ask("undo");
    page().send("apply", {{"operation", lift(0.3)}});  // nobody was told that this is done
    (void)std::raise(SIGKILL);
    std::abort();
  }
};

TEST_F(SessionThatDies, NothingThatWasAnsweredIsLost) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const fs::path journal = fs::temp_directory_path() / "pointskin_studio_killed.jsonl";
  EXPECT_EXIT(work_and_die(journal), testing::KilledBySignal(SIGKILL), "");
  resume(journal);
  const Json scene = fresh_scene();
  ASSERT_GE(scene.at("history").size(), 3U);
  (void)page().ask("go", {{"done", 2}});
  EXPECT_EQ(digest(), test::replayed("torus", 6'000, 5, {three()[0], three()[1]}));
  if (scene.at("done") == 2) {  // else the last one had come to the disk
    (void)page().ask("redo");
    EXPECT_EQ(digest(), test::replayed("torus", 6'000, 5, three()));
  }
  stop();
  fs::remove(journal);
}

TEST_F(SessionJournal, TheNewestJournalIsResumed) {
  open_shape("sphere");
  open_shape("torus");
  for (const Json& operation : three()) apply(operation);
  (void)page().ask("go", {{"done", 1}});
  const std::string before = digest();
  resume();
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(fresh_scene().at("history").size(), 3U);
  apply(lift(0.1));
  const std::string after = digest();
  resume();
  EXPECT_EQ(digest(), after) << "it was gone on with";
  EXPECT_EQ(fresh_scene().at("history").size(), 2U);
}

TEST_F(SessionJournal, ATornLastLineIsNoHindrance) {
  open_shape();
  apply(lift(0.2));
  const std::string before = digest();
  const fs::path journal = fresh_scene().at("journal").get<std::string>();
  stop();
  std::ofstream(journal, std::ios::app) << R"({"apply": {"op": "def)";
  resume();
  EXPECT_EQ(digest(), before);
  apply(lift(0.1));
  resume();
  EXPECT_EQ(fresh_scene().at("history").size(), 2U);
}

TEST_F(SessionJournal, AJournalIsItsOwnersAlone) {
  open_shape();
  const std::string journal = fresh_scene().at("journal");
  EXPECT_EQ(fs::path(journal).parent_path(), folder());
  struct stat facts {};
  ASSERT_EQ(stat(journal.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0600U);
}

TEST_F(SessionJournal, ResumingNothingIsRefused) {
  EXPECT_THROW(resume(), std::exception);
  EXPECT_THROW(resume(root() / "none.jsonl"), std::exception);
}

TEST_F(SessionJournal, WhatDoesNotComeToTheDiskIsNotDone) {
  open_shape();
  const std::string before = digest();
  const fs::path journal = fresh_scene().at("journal").get<std::string>();
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit tight{fs::file_size(journal) + 10, old.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const std::string code = page().refusal("apply", {{"operation", lift(0.2)}});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(code, "output_not_written");
  EXPECT_EQ(fresh_scene().at("done"), 0);
  EXPECT_EQ(digest(), before);
  apply(lift(0.1));
  resume();
  EXPECT_EQ(fresh_scene().at("done"), 1);
}

}  // namespace
}  // namespace pointskin
