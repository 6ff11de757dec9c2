// Journals outlive the program: what was acknowledged is there, whatever was being written. Session files know their
// clouds again.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "scene/journal.hpp"
#include "studio/scene/scene_support.hpp"

namespace pointskin::test {
namespace {

using scene::Document;
using scene::Journal;

Document beginning(const SceneFolder& folder) {
  Document document;
  document.base.clouds.push_back(scene::cloud_of_file(folder / "a.ply"));
  document.base.shift = "1,2.5,-3";
  document.options.depth = 5;
  return document;
}

scene::SceneOperation options(int depth) { return scene::Configure{nlohmann::json{{"depth", depth}}}; }

/// Runs `child` in a process that ends by `end`. @returns how it ended
template <class Child>
int run_child(const Child& child) {
  const pid_t pid = fork();
  if (pid == 0) {
    child();
    _exit(0);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  return status;
}

void append_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::app | std::ios::binary) << text;
}

TEST(SceneJournal, HoldsWhatWasAppliedAndWhereOneWent) {
  const SceneFolder folder;
  const std::string path = folder / "journal";
  {
    Journal journal = Journal::create(path, beginning(folder));
    for (const std::string& text : one_of_every_kind()) journal.apply(operation_from(text));
    journal.go(4);
    journal.apply(options(7));
    journal.apply(options(8));
    journal.go(5);
  }
  const Document document = scene::read_journal(path);
  ASSERT_EQ(document.operations.size(), 6U);
  EXPECT_EQ(document.done, 5U);
  EXPECT_EQ(document.options.depth, 5);
  EXPECT_EQ(document.base.clouds.at(0).file, folder / "a.ply");
  EXPECT_EQ(document.base.shift, "1,2.5,-3");
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(document.operations[i], scene::to_json(operation_from(one_of_every_kind()[i]), ""));
  EXPECT_EQ(document.operations[5]["depth"], 8);
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST(SceneJournal, IsWholeAfterAnAbortInTheMiddleOfALine) {
  const SceneFolder folder;
  const std::string path = folder / "journal";
  const int status = run_child([&] {
    Journal journal = Journal::create(path, beginning(folder));
    journal.apply(options(6));
    journal.apply(options(7));
    append_text(path, R"({"apply":{"op":"opt)");  // what a write that was cut off leaves
    std::abort();
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(scene::read_journal(path).operations.size(), 2U);
  Journal journal = Journal::open(path);
  journal.apply(options(8));
  const Document document = scene::read_journal(path);
  ASSERT_EQ(document.operations.size(), 3U);
  EXPECT_EQ(document.operations[2]["depth"], 8);
}

TEST(SceneJournal, HasAllThatWasAcknowledgedWhenTheProgramIsKilled) {
  const SceneFolder folder;
  const std::string path = folder / "journal";
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t pid = fork();
  if (pid == 0) {
    Journal journal = Journal::create(path, beginning(folder));
    for (int i = 0; i < 100'000; ++i) {
      journal.apply(options(1 + i % 20));
      if (write(pipe_ends[1], "x", 1) != 1) _exit(1);
    }
    _exit(0);
  }
  close(pipe_ends[1]);
  std::size_t acknowledged = 0;
  for (char byte = 0; acknowledged < 40 && read(pipe_ends[0], &byte, 1) == 1;) ++acknowledged;
  kill(pid, SIGKILL);
  for (char byte = 0; read(pipe_ends[0], &byte, 1) == 1;) ++acknowledged;
  close(pipe_ends[0]);
  waitpid(pid, nullptr, 0);
  EXPECT_GE(acknowledged, 40U);
  const std::size_t there = scene::read_journal(path).operations.size();
  EXPECT_GE(there, acknowledged);
  EXPECT_LE(there, acknowledged + 1);
}

TEST(SceneJournal, RefusesLinesThatAreWrong) {
  const SceneFolder folder;
  const std::string path = folder / "journal";
  for (const char* line : {"{\"apply\": {\"op\": \"bend\"}}\n", "{\"go\": 2}\n", "nonsense\n", "{}\n",
                           "{\"apply\": {\"op\": \"undo\"}}\n"}) {
    Journal::create(path, beginning(folder)).apply(options(6));
    append_text(path, line);
    append_text(path, "{\"go\": 0}\n");
    try {
      (void)scene::read_journal(path);
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_NE(std::string(error.what()).find("journal:3"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW((void)scene::read_journal(folder / "none"), Error);
  EXPECT_THROW((void)Journal::create("/proc/journal", beginning(folder)), Error);
}

TEST(SessionFile, NamesItsCloudsFromItsFolderAndTellsWhatChanged) {
  const SceneFolder folder;
  std::filesystem::create_directory(folder / "deeper");
  const std::string cloud = folder / "a.ply", path = folder / "deeper/scene.json";
  write_cloud(cloud, small_cloud(100));
  Document document = beginning(folder);
  scene::stamp_clouds(document.base);
  document.operations.push_back(scene::to_json(operation_from(one_of_every_kind()[0]), ""));
  document.operations.push_back({{"op", "boolean"}, {"operation", "union"}, {"with", {{"file", folder / "b.ply"}}}});
  document.done = 1;
  write_document(path, document);

  const nlohmann::json json = nlohmann::json::parse(std::ifstream(path));
  EXPECT_EQ(json["clouds"][0]["file"], "../a.ply");
  EXPECT_EQ(json["operations"][1]["with"]["file"], "../b.ply");
  std::filesystem::rename(folder / "deeper", folder / "other");
  const Document read = scene::read_document(folder / "other/scene.json");
  EXPECT_EQ(read.base.clouds[0].file, cloud);
  EXPECT_EQ(read.base.clouds[0].sha256, document.base.clouds[0].sha256);
  EXPECT_EQ(read.operations, document.operations);
  EXPECT_EQ(read.done, 1U);
  EXPECT_TRUE(check_clouds(read.base).empty());

  write_cloud(cloud, small_cloud(101));
  const std::vector<std::string> notices = check_clouds(read.base);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("a.ply"), std::string::npos);
  std::filesystem::remove(cloud);
  try {
    (void)check_clouds(read.base);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_NE(std::string(error.what()).find("a.ply"), std::string::npos) << error.what();
  }
}

// FIPS 180-4's own examples, and lengths around the padding's edges against each other.
TEST(Sha256, IsThatOfTheStandard) {
  const auto sum_of = [](const std::string& text) {
    scene::Sha256 sum;
    sum.add(text);
    return sum.finish();
  };
  EXPECT_EQ(sum_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sum_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sum_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sum_of(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  scene::Sha256 pieces;
  for (int i = 0; i < 1'000'000; i += 1000) pieces.add(std::string(1000, 'a'));
  EXPECT_EQ(pieces.finish(), sum_of(std::string(1'000'000, 'a')));
}

}  // namespace
}  // namespace pointskin::test
