// Bytes in a file without a name: they come back, and nothing is left.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "scale/spool.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using scale::Spool;

std::string path_of(const TemporaryFolder& folder) {
  return std::filesystem::path(folder.file("any")).parent_path().string();
}

/// The descriptor of a file without a name in `folder`, as a path.
std::filesystem::path open_file_in(const std::string& folder) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code none;
    const std::string target = std::filesystem::read_symlink(entry.path(), none).string();
    if (target.starts_with(folder) && target.ends_with("(deleted)")) return entry.path();
  }
  return {};
}

TEST(Spool, GivesBackWhatWasWrittenFromAnyThread) {
  const TemporaryFolder folder;
  constexpr std::int64_t kCount = 1'000'000;
  constexpr std::int64_t kThreads = 4;
  std::vector<std::int64_t> values(kCount);
  Random random(1);
  for (std::int64_t& v : values) v = random.below(1'000'000'007);
  const auto width = static_cast<std::int64_t>(sizeof(std::int64_t));
  const Spool spool(path_of(folder), kCount * width);
  EXPECT_EQ(spool.size(), kCount * width);
  std::vector<std::thread> threads;
  for (std::int64_t t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (std::int64_t first = 1000 * t; first < kCount; first += 1000 * kThreads)
        spool.write(first * width, values.data() + first, 1000 * width);
    });
  for (std::thread& thread : threads) thread.join();
  std::vector<std::int64_t> back(kCount);
  spool.read(0, back.data(), kCount * width);
  EXPECT_EQ(back, values);
  std::vector<std::int64_t> part(777);
  spool.read(123'456 * width, part.data(), 777 * width);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), values.begin() + 123'456));
}

TEST(Spool, IsZeroBeforeAnythingIsWrittenAndMayBeEmpty) {
  const TemporaryFolder folder;
  const Spool spool(path_of(folder), 5000);
  std::vector<char> bytes(5000, 'x');
  spool.read(0, bytes.data(), 5000);
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), '\0'), 5000);
  const Spool none(path_of(folder), 0);
  EXPECT_EQ(none.size(), 0);
  none.read(0, bytes.data(), 0);
}

TEST(Spool, HasNoName) {
  const TemporaryFolder folder;
  const Spool spool(path_of(folder), 1 << 20);
  EXPECT_EQ(folder.file_count(), 0U);
  EXPECT_FALSE(open_file_in(path_of(folder)).empty());
}

TEST(Spool, SaysWhereItFoundNoRoom) {
  const TemporaryFolder folder;
  const std::string too_large =
      story_of(ErrorCode::output_not_written, [&] { Spool(path_of(folder), std::int64_t{1} << 60); });
  EXPECT_NE(too_large.find("no room for 1.15e+09 GB"), std::string::npos) << too_large;
  EXPECT_EQ(folder.file_count(), 0U);
  const std::string nowhere = story_of(ErrorCode::output_not_written, [&] { Spool(folder.file("missing"), 10); });
  EXPECT_NE(nowhere.find("missing: no temporary file can be made, No such file"), std::string::npos) << nowhere;
}

TEST(Spool, ThatHasBecomeShorterIsAnError) {
  const TemporaryFolder folder;
  const Spool spool(path_of(folder), 10'000);
  std::filesystem::resize_file(open_file_in(path_of(folder)), 4'000);
  std::vector<char> bytes(10'000);
  for (const std::int64_t count : {1'000, 10'000}) {
    const std::string story = story_of(ErrorCode::output_not_written, [&] { spool.read(0, bytes.data(), count); });
    EXPECT_NE(story.find("cannot be read"), std::string::npos) << story;
  }
  // Else what lies between would be zeros from now on, and nobody would know.
  const std::string story = story_of(ErrorCode::output_not_written, [&] { spool.write(9'000, bytes.data(), 1'000); });
  EXPECT_NE(story.find("cannot be written"), std::string::npos) << story;
}

}  // namespace
}  // namespace pointskin::test
