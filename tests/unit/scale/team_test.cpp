// What ranks tell each other, with threads as ranks.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "scale/team.hpp"
#include "support/io_files.hpp"
#include "support/thread_ranks.hpp"

namespace pointskin::scale {
namespace {

using test::run_as_ranks;

TEST(Team, OfOneHasWhatItFoundItself) {
  const Team team;
  EXPECT_TRUE(team.is_alone() && team.is_first());
  EXPECT_EQ(team.size(), 1);
  EXPECT_EQ(team.gather_all(std::vector<int>{3, 4}), (std::vector<int>{3, 4}));
  EXPECT_EQ(team.reduce(5, std::plus<>{}), 5);
  EXPECT_EQ(team.share_of(7).begin, 0);
  EXPECT_EQ(team.share_of(7).end, 7);
  team.wait();
  EXPECT_THROW(team.together([] { throw std::logic_error("as it is"); }), std::logic_error);
}

TEST(Team, GathersInTheOrderOfTheRanks) {
  for (const int count : {2, 3, 7})
    run_as_ranks(count, [&](Ranks& ranks) {
      const Team team(&ranks);
      EXPECT_EQ(team.size(), count);
      const std::int64_t rank = ranks.rank();
      const std::vector<std::vector<std::int64_t>> all =
          team.gather(std::vector<std::int64_t>(static_cast<std::size_t>(rank), 10 + rank));  // the first has none
      for (std::int64_t r = 0; r < count; ++r)
        EXPECT_EQ(all[static_cast<std::size_t>(r)], std::vector<std::int64_t>(static_cast<std::size_t>(r), 10 + r));
      EXPECT_EQ(team.reduce(rank, std::plus<>{}), count * (count - 1) / 2);
      EXPECT_EQ(team.of_first(rank), 0);
    });
}

TEST(Team, SharesAreRunsThatCoverAll) {
  run_as_ranks(3, [](Ranks& ranks) {
    const Team team(&ranks);
    for (const std::int64_t n : {0, 1, 2, 3, 10, 100'000}) {
      std::int64_t end = 0;
      for (int rank = 0; rank < 3; ++rank) {
        const Team::Share share = team.share_of(n, rank);
        EXPECT_EQ(share.begin, end);
        EXPECT_LE(share.end - share.begin, n / 3 + 1);
        end = share.end;
      }
      EXPECT_EQ(end, n);
    }
  });
}

/// Memory is what another division may need less of; all else is for the rank that meets it.
TEST(Team, FailsTogetherWhereOneHasNoMemory) {
  std::atomic<int> failed{0};
  run_as_ranks(3, [&](Ranks& ranks) {
    const Team team(&ranks);
    try {
      team.together([&] {
        if (ranks.rank() == 1) throw Error(ErrorCode::over_limit, "too much");
      });
    } catch (const FailedTogether& error) {
      EXPECT_EQ(error.code(), ErrorCode::over_limit);
      EXPECT_STREQ(error.what(), "too much");
      ++failed;
    }
    team.together([] {});
  });
  EXPECT_EQ(failed, 3);
  EXPECT_THROW(run_as_ranks(3,
                            [](Ranks& ranks) {
                              Team(&ranks).together([&] {
                                if (ranks.rank() == 2) throw Error(ErrorCode::output_not_written, "disk");
                              });
                            }),
               Error);
}

TEST(Team, WritesAndReadsOneSpool) {
  const test::TemporaryFolder folder;
  run_as_ranks(3, [&](Ranks& ranks) {
    const Team team(&ranks);
    constexpr std::int64_t kBytes = sizeof(int);
    const std::unique_ptr<Spool> spool = team.make_spool(folder.file(""), 3 * kBytes);
    EXPECT_EQ(spool->size(), 3 * kBytes);
    const int own = 100 + ranks.rank();
    spool->write(ranks.rank() * kBytes, &own, kBytes);
    team.wait();
    EXPECT_EQ(folder.file_count(), 0U);  // no names
    int all[3] = {};
    spool->read(0, all, sizeof all);
    for (int rank = 0; rank < 3; ++rank) EXPECT_EQ(all[rank], 100 + rank);
  });
}

TEST(Team, SharesSpoolsThatRanksHaveMade) {
  const test::TemporaryFolder folder;
  run_as_ranks(2, [&](Ranks& ranks) {
    const Team team(&ranks);
    std::vector<std::unique_ptr<Spool>> spools(4);  // 0 and 2 are the first rank's
    std::vector<std::unique_ptr<Spool>*> all;
    for (std::size_t i = 0; i < spools.size(); ++i) {
      all.push_back(&spools[i]);
      if (static_cast<int>(i % 2) != ranks.rank()) continue;
      spools[i] = std::make_unique<Spool>(folder.file(""), 1 + static_cast<std::int64_t>(i), SpoolName::when_shown);
      const char byte = static_cast<char>('a' + i);
      spools[i]->write(0, &byte, 1);
    }
    team.share_spools(folder.file(""), all);
    team.wait();
    EXPECT_EQ(folder.file_count(), 0U);
    for (std::size_t i = 0; i < spools.size(); ++i) {
      char byte = 0;
      spools[i]->read(0, &byte, 1);
      EXPECT_EQ(byte, static_cast<char>('a' + i));
      EXPECT_EQ(spools[i]->size(), 1 + static_cast<std::int64_t>(i));
    }
  });
}

/// As on hosts that each have a disk of their own.
TEST(Team, TellsThatAFolderIsNotShared) {
  const test::TemporaryFolder folders[2];
  try {
    run_as_ranks(2, [&](Ranks& ranks) { (void)Team(&ranks).make_spool(folders[ranks.rank()].file(""), 10); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::output_not_written);
    EXPECT_NE(std::string(error.what()).find("one folder that they share"), std::string::npos) << error.what();
  }
  EXPECT_EQ(folders[0].file_count() + folders[1].file_count(), 0U);
}

}  // namespace
}  // namespace pointskin::scale
