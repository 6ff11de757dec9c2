// Records sorted on a disk, against std::stable_sort.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "exec/cpu.hpp"
#include "scale/disk_sort.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using scale::DiskSort;
using scale::Spool;

struct Record {
  std::uint64_t key = 0, tie = 0;
  std::int32_t number = 0;  ///< as added
  std::int32_t other = 0;
  friend bool operator==(const Record&, const Record&) = default;
};

using Records = std::vector<Record>;

/// @param keys  so many different ones, up to 2^63 and more
Records random_records(std::int64_t count, std::int64_t keys, std::int64_t ties, std::uint64_t seed) {
  Random random(seed);
  Records records;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto key = static_cast<std::uint64_t>(random.below(keys)) * 0x9e3779b97f4a7c15U;
    const auto number = static_cast<std::int32_t>(i);
    records.push_back({key, static_cast<std::uint64_t>(random.below(ties)), number, -number});
  }
  return records;
}

std::string folder_path(const TemporaryFolder& folder) {
  return std::filesystem::path(folder.file("any")).parent_path().string();
}

struct Result {
  Records records;
  std::int64_t runs = 0;
};

Result sorted_on_disk(const Records& records, std::int64_t memory, int threads, std::size_t at_once) {
  const TemporaryFolder folder;
  exec::Cpu ex(threads);
  const auto count = static_cast<std::int64_t>(records.size());
  DiskSort sort(ex, {folder_path(folder), count, sizeof(Record), memory});
  for (std::size_t first = 0; first < records.size(); first += at_once)
    sort.add(reinterpret_cast<const std::byte*>(records.data() + first),
             static_cast<std::int64_t>(std::min(at_once, records.size() - first)));
  const std::unique_ptr<Spool> spool = sort.finish();
  EXPECT_EQ(folder.file_count(), 0U);
  Result result{Records(records.size()), sort.runs()};
  spool->read(0, result.records.data(), count * static_cast<std::int64_t>(sizeof(Record)));
  return result;
}

Records expected_of(Records records) {
  std::stable_sort(records.begin(), records.end(),
                   [](const Record& a, const Record& b) { return std::tie(a.key, a.tie) < std::tie(b.key, b.tie); });
  return records;
}

TEST(DiskSort, IsAsStableSortForAnyMemoryAndThreads) {
  for (const std::int64_t keys : {std::int64_t{1} << 50, std::int64_t{300}, std::int64_t{1}}) {
    const Records records = random_records(50'000, keys, 1'000, 1);
    const Records expected = expected_of(records);
    for (const std::int64_t memory : {std::int64_t{0}, std::int64_t{300'000}, std::int64_t{1} << 30})
      for (const int threads : {1, 2, 7}) {
        const Result result = sorted_on_disk(records, memory, threads, 777);
        EXPECT_EQ(result.runs > 1, memory < 1 << 30);
        ASSERT_TRUE(result.records == expected) << keys << " keys, memory " << memory << ", threads " << threads;
      }
  }
}

TEST(DiskSort, KeepsTheOrderOfRecordsThatAreAlike) {
  const Records records = random_records(20'000, 5, 1, 2);
  EXPECT_TRUE(sorted_on_disk(records, 0, 3, 20'000).records == expected_of(records));
}

TEST(DiskSort, TakesFewRecordsAndNone) {
  for (const std::int64_t count : {0, 1, 2, 1023, 1024, 1025, 2048}) {
    const Records records = random_records(count, 1'000'000, 2, 3);
    EXPECT_TRUE(sorted_on_disk(records, 0, 2, 100).records == expected_of(records)) << count;
  }
}

TEST(DiskSort, MayGetFewerRecordsThanWereSaid) {
  const TemporaryFolder folder;
  exec::Cpu ex(2);
  const Records records = random_records(3'000, 1'000'000, 2, 4);
  DiskSort sort(ex, {folder_path(folder), 10'000, sizeof(Record), 0});
  sort.add(reinterpret_cast<const std::byte*>(records.data()), 3'000);
  const std::unique_ptr<Spool> spool = sort.finish();
  Records back(3'000);
  spool->read(0, back.data(), 3'000 * static_cast<std::int64_t>(sizeof(Record)));
  EXPECT_TRUE(back == expected_of(records));
}

TEST(DiskSort, SaysBeforeItBeginsThatThereIsNoRoom) {
  const TemporaryFolder folder;
  exec::Cpu ex(1);
  const std::string story = story_of(ErrorCode::output_not_written, [&] {
    DiskSort(ex, {folder_path(folder), std::int64_t{1} << 55, 32, 1 << 20});
  });
  EXPECT_NE(story.find("no room"), std::string::npos) << story;
}

}  // namespace
}  // namespace pointskin::test
