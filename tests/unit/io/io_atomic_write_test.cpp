#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <thread>

#include "io/output.hpp"
#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::bytes_of_file;
using test::make_file;
using test::story_of;
using test::TemporaryFolder;

mode_t mode_of(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 0777;
}

TEST(AtomicWrite, ReplacesTheFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old and longer");
  write_file_atomically(folder.file("a"), "new");
  EXPECT_EQ(bytes_of_file(folder.file("a")), "new");
  EXPECT_EQ(folder.file_count(), 1u);
}

io::Blocks one_block(const std::string& bytes) {
  return {1, [bytes](std::int64_t /*block*/, std::string& to) { to = bytes; }};
}

TEST(AtomicWrite, ReplacesFilesTogether) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  exec::Cpu ex(2);
  {
    io::FilesTogether files;
    files.write(ex, folder.file("a"), one_block("first"));
    files.write(ex, folder.file("b"), one_block("second"));
    EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
    EXPECT_FALSE(std::filesystem::exists(folder.file("b")));
    files.replace();
  }
  EXPECT_EQ(bytes_of_file(folder.file("a")), "first");
  EXPECT_EQ(bytes_of_file(folder.file("b")), "second");
  EXPECT_EQ(folder.file_count(), 2u);
}

TEST(AtomicWrite, KeepsAllFilesWhereOneOfSeveralCannotBeWritten) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  exec::Cpu ex(2);
  {
    io::FilesTogether files;
    files.write(ex, folder.file("a"), one_block("first"));
    EXPECT_NE(
        story_of(ErrorCode::output_not_written, [&] { files.write(ex, folder.file("none/b"), one_block("second")); }),
        "");
  }
  EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

/// Of ten bytes each.
io::Blocks three_blocks() {
  io::Blocks blocks{3, [](std::int64_t b, std::string& to) { to += std::string(10, static_cast<char>('a' + b)); }};
  blocks.place = [](std::int64_t b) { return 10 * b; };
  return blocks;
}

TEST(AtomicWrite, WritesAFileOfManyPartByPart) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old and with permissions");
  ASSERT_EQ(::chmod(folder.file("a").c_str(), 0640), 0);
  exec::Cpu ex(2);
  {
    io::FileOfMany first = io::FileOfMany::make(folder.file("a"));
    io::FileOfMany second = io::FileOfMany::open(folder.file("a"), first.temporary_name());
    second.write(ex, three_blocks(), 1, 3);
    second.finish();
    EXPECT_EQ(bytes_of_file(folder.file("a")), "old and with permissions");
    first.write(ex, three_blocks(), 0, 1);
    first.finish();
    first.replace();
    second.forget();
  }
  EXPECT_EQ(bytes_of_file(folder.file("a")), "aaaaaaaaaabbbbbbbbbbcccccccccc");
  EXPECT_EQ(mode_of(folder.file("a")), 0640U);
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(AtomicWrite, RemovesAFileOfManyWhereOneOfThemGivesUp) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  exec::Cpu ex(1);
  io::FileOfMany first = io::FileOfMany::make(folder.file("a"));
  {
    io::FileOfMany second = io::FileOfMany::open(folder.file("a"), first.temporary_name());
    second.write(ex, three_blocks(), 0, 3);
  }
  EXPECT_EQ(folder.file_count(), 1U);
  EXPECT_NE(story_of(ErrorCode::output_not_written, [&] { first.replace(); }), "");
  EXPECT_NE(story_of(ErrorCode::output_not_written,
                     [&] { (void)io::FileOfMany::open(folder.file("a"), first.temporary_name()); }),
            "");
  EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
}

TEST(AtomicWrite, WritesAllOfALargeFile) {
  const TemporaryFolder folder;
  std::string bytes(20'000'000, 'x');
  bytes[19'999'999] = 'y';
  write_file_atomically(folder.file("a"), bytes);
  EXPECT_EQ(bytes_of_file(folder.file("a")), bytes);
}

TEST(AtomicWrite, FollowsTheUserMaskForNewFilesAndKeepsThePermissionsOfOldOnes) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(027);
  write_file_atomically(folder.file("new"), "x");
  ::umask(before);
  EXPECT_EQ(mode_of(folder.file("new")), 0640u);
  ASSERT_EQ(::chmod(folder.file("new").c_str(), 0604), 0);
  write_file_atomically(folder.file("new"), "y");
  EXPECT_EQ(mode_of(folder.file("new")), 0604u);
}

TEST(AtomicWrite, FollowsSymbolicLinksAlsoToFilesThatAreYetToCome) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("there"));
  std::filesystem::create_symlink("there/target", folder.file("link"));
  std::filesystem::create_symlink(folder.file("link"), folder.file("link_to_link"));
  for (const char* bytes : {"first", "second"}) {
    write_file_atomically(folder.file("link_to_link"), bytes);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link_to_link")));
    EXPECT_EQ(bytes_of_file(folder.file("there/target")), bytes);
  }
  std::filesystem::create_symlink("loop", folder.file("loop"));
  EXPECT_NE(story_of(ErrorCode::output_not_written, [&] { write_file_atomically(folder.file("loop"), "x"); }), "");
}

TEST(AtomicWrite, TellsTheReasonOfTheOperatingSystem) {
  const TemporaryFolder folder;
  const auto story = [](const std::string& path) {
    return story_of(ErrorCode::output_not_written, [&] { write_file_atomically(path, "x"); });
  };
  EXPECT_NE(story(folder.file("none/a")).find("No such file or directory"), std::string::npos);
  EXPECT_NE(story(folder.file("")).find("Is a directory"), std::string::npos);
  EXPECT_NE(story("/dev/full").find("No space left on device"), std::string::npos);
  EXPECT_NE(story(""), "");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(AtomicWrite, WritesSpecialFilesInPlace) {
  write_file_atomically("/dev/null", "x");
  write_mesh("/dev/null", {});
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = bytes_of_file(folder.file("pipe")); });
  write_file_atomically(folder.file("pipe"), "through the pipe");
  reader.join();
  EXPECT_EQ(received, "through the pipe");
  EXPECT_TRUE(std::filesystem::is_fifo(folder.file("pipe")));
}

TEST(AtomicWrite, LeavesTheOldFileAndNoOtherWhenTheDiskRefusesHalfway) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  // A limit on the size of files stands in for a full disk: the write comes short, the next one fails with EFBIG.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string story =
      story_of(ErrorCode::output_not_written, [&] { write_file_atomically(folder.file("a"), std::string(5000, 'x')); });
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_NE(story.find("File too large"), std::string::npos) << story;
  EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicWrite, RefusesAWriteProtectedFile) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everything";
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  ASSERT_EQ(::chmod(folder.file("a").c_str(), 0444), 0);
  EXPECT_NE(story_of(ErrorCode::output_not_written, [&] { write_file_atomically(folder.file("a"), "x"); }), "");
  EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
}

TEST(AtomicWrite, TakesNamesAsLongAsTheFileSystemDoes) {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string(255, 'n'));
  write_file_atomically(path, "x");
  EXPECT_EQ(bytes_of_file(path), "x");
}

TEST(AtomicWrite, MayReplaceTheFileThatWasJustRead) {
  const TemporaryFolder folder;
  make_file(folder.file("a.obj"), "v 1 2 3\nv 4 5 6\nv 7 8 0\nf 1 2 3\n");
  const Mesh mesh = read_mesh(folder.file("a.obj"));
  write_mesh(folder.file("a.obj"), mesh);
  EXPECT_EQ(read_mesh(folder.file("a.obj")).vertices, mesh.vertices);
}

}  // namespace
}  // namespace pointskin
