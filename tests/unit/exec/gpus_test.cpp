// How several GPUs share work, on the host: shares, the cuts of sorted runs, and who waits for whom on GPUs that only remember.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "exec/gpus/layout.hpp"
#include "exec/gpus/merge_cuts.hpp"
#include "exec/gpus/order.hpp"
#include "exec/gpus/shares.hpp"

namespace pointskin::exec::gpus {
namespace {

TEST(Shares, CoverAllWithoutGapsAndDifferByOneAtMost) {
  for (const int count : {1, 2, 3, 4, 7})
    for (const std::int64_t n : {0L, 1L, 3L, 4L, 1000L, 6'000'000'001L}) {
      const Shares shares{n, count};
      EXPECT_EQ(shares.begin(0), 0);
      EXPECT_EQ(shares.end(count - 1), n);
      for (int g = 0; g < count; ++g) {
        EXPECT_LE(shares.size(g), n / count + 1);
        EXPECT_GE(shares.size(g), n / count);
      }
    }
}

TEST(Shares, CountBeyond32Bits) {
  const Shares shares{std::int64_t{1} << 40, 4};
  EXPECT_EQ(shares.begin(3), 3 * (std::int64_t{1} << 38));
}

TEST(Shares, OfMemoryAreWholePages) {
  constexpr std::size_t kPage = 2 << 20;
  EXPECT_EQ(whole_pages(1, kPage), kPage);
  EXPECT_EQ(whole_pages(4 * kPage, kPage), 4 * kPage);
  EXPECT_EQ(whole_pages(4 * kPage + 1, kPage), 5 * kPage);
  EXPECT_TRUE(may_stand_in(9 * kPage, 8 * kPage));
  EXPECT_FALSE(may_stand_in(10 * kPage, 8 * kPage));
  EXPECT_FALSE(may_stand_in(7 * kPage, 8 * kPage));
}

using Intervals = std::vector<Layout::Interval>;

TEST(Layout, GivesEachGpuItsShareOfEveryPart) {
  const Layout layout({40}, 100);
  EXPECT_EQ(layout.of_gpu(0, 2, 100), (Intervals{{0, 20}, {40, 70}}));
  EXPECT_EQ(layout.of_gpu(1, 2, 100), (Intervals{{20, 40}, {70, 100}}));
  EXPECT_EQ(layout.of_gpu(1, 2, 1000), (Intervals{{200, 400}, {700, 1000}})) << "in proportion";
}

TEST(Layout, OfOnePartIsThatOfShares) {
  EXPECT_EQ(Layout().of_gpu(1, 4, 10), (Intervals{{2, 5}}));
  EXPECT_EQ(Layout({0, 10, 10}, 10), Layout()) << "empty parts";
}

TEST(Layout, CoversAllOnceWhateverTheSize) {
  const Layout layout({1, 7, 7, 300, 999}, 1000);
  for (const int count : {2, 3, 4, 7})
    for (const std::int64_t n : {1L, 2L, 5L, 999L, 123'456'789'012L}) {
      Intervals all;
      for (int g = 0; g < count; ++g)
        for (const Layout::Interval& own : layout.of_gpu(g, count, n)) all.push_back(own);
      std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
      std::int64_t end = 0;
      for (const Layout::Interval& own : all) {
        EXPECT_EQ(own.begin, end);
        EXPECT_GT(own.end, own.begin);
        end = own.end;
      }
      EXPECT_EQ(end, n);
    }
}

TEST(Layout, TellsOwnersInTheOrderOfElements) {
  EXPECT_EQ(owners_of(Layout({4}, 10), 2, 10),
            (std::vector<Owned>{{0, {0, 2}}, {1, {2, 4}}, {0, {4, 7}}, {1, {7, 10}}}));
}

/// Sorted runs of `keys`, one a share, and what a stable sort of all makes of them.
struct RunsOfKeys {
  std::vector<std::uint64_t> keys;
  SortedRuns runs;
  std::vector<std::size_t> order;  // of all: places in `keys`

  RunsOfKeys(std::vector<std::uint64_t> given, int count, KeyBits bits)
      : keys(std::move(given)),
        runs{nullptr, {static_cast<std::int64_t>(keys.size()), count}, bits},
        order(keys.size()) {
    const auto less = [&](std::uint64_t a, std::uint64_t b) { return bits(a) < bits(b); };
    for (int g = 0; g < count; ++g)
      std::stable_sort(keys.begin() + runs.shares.begin(g), keys.begin() + runs.shares.end(g), less);
    runs.keys = keys.data();
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return less(keys[a], keys[b]); });
  }
};

/// As the kernel does it, lane after lane.
std::int64_t find_cut(const SortedRuns& runs, int run, std::int64_t first_of_all, int lanes) {
  CutSearch search{runs, run, first_of_all, 0, runs.shares.size(run)};
  while (!search.is_done()) {
    int belonging = 0;
    for (int lane = 0; lane < lanes; ++lane) belonging += search.belongs(search.place(lane, lanes)) ? 1 : 0;
    search.narrow(belonging, lanes);
  }
  return search.low;
}

void expect_exact_cuts(const RunsOfKeys& of, int lanes) {
  const Shares& shares = of.runs.shares;
  for (int part = 0; part < shares.count; ++part)
    for (int run = 0; run < shares.count; ++run) {
      const auto first = of.order.begin();
      const auto expected = std::count_if(first, first + shares.begin(part), [&](std::size_t place) {
        const auto at = static_cast<std::int64_t>(place);
        return at >= shares.begin(run) && at < shares.end(run);
      });
      ASSERT_EQ(find_cut(of.runs, run, shares.begin(part), lanes), expected) << "part " << part << ", run " << run;
    }
}

TEST(MergeCuts, AreThoseOfAStableSortOfAll) {
  std::mt19937_64 random(1);
  for (const int count : {2, 3, 4, 7})
    for (const std::size_t n : {0UL, 1UL, 5UL, 64UL, 1000UL})
      for (const std::uint64_t distinct : {1UL, 2UL, 10UL, ~0UL}) {
        std::vector<std::uint64_t> keys(n);
        for (std::uint64_t& key : keys) key = random() % distinct;
        SCOPED_TRACE(testing::Message() << count << " runs of " << n << " keys, of " << distinct);
        for (const int lanes : {1, 32}) expect_exact_cuts({keys, count, {0, 64}}, lanes);
      }
}

TEST(MergeCuts, AskOnlyTheBitsThatAreSortedBy) {
  std::mt19937_64 random(2);
  std::vector<std::uint64_t> keys(777);
  for (std::uint64_t& key : keys) key = random();
  expect_exact_cuts({keys, 4, {30, 34}}, 32);
  expect_exact_cuts({keys, 4, {0, 3}}, 32);
}

/// GPUs that remember what they were given, and when: clock[g][h] pieces of GPU h have ended before what GPU g gets next begins.
class FakeGpus {
 public:
  explicit FakeGpus(int count) : clocks_(size(count), std::vector<int>(size(count))), marks_(clocks_) {}

  void record(int g) { marks_[size(g)] = clocks_[size(g)]; }
  void wait(int g, int other) {
    for (std::size_t h = 0; h < clocks_.size(); ++h)
      clocks_[size(g)][h] = std::max(clocks_[size(g)][h], marks_[size(other)][h]);
    ++waits_;
  }
  /// A piece of work on GPU g: everything before must be seen, and of this round nothing of the others.
  void work(int g, const std::vector<int>& before) {
    EXPECT_EQ(clocks_[size(g)], before) << "GPU " << g;
    ++clocks_[size(g)][size(g)];
    ++done_[size(g)];
  }
  [[nodiscard]] std::vector<int> all_done() const {
    return {done_.begin(), done_.begin() + static_cast<long>(clocks_.size())};
  }
  [[nodiscard]] int waits() const { return waits_; }

 private:
  static std::size_t size(int g) { return static_cast<std::size_t>(g); }

  std::vector<std::vector<int>> clocks_, marks_;
  std::vector<int> done_ = std::vector<int>(8);
  int waits_ = 0;
};

void spread(Order& order, FakeGpus& gpus, int count) {
  const std::vector<int> before = gpus.all_done();
  order.to_all(gpus);
  for (int g = 0; g < count; ++g) {
    gpus.work(g, before);
    gpus.record(g);
  }
}

void by_lead(Order& order, FakeGpus& gpus) {
  const std::vector<int> before = gpus.all_done();
  order.to_lead(gpus);
  gpus.work(0, before);
}

TEST(Order, LetsEveryPieceSeeAllBeforeAndNoneOfItsOwnRound) {
  for (const int count : {2, 4, 7}) {
    Order order(count);
    FakeGpus gpus(count);
    std::mt19937 random(static_cast<unsigned>(count));
    for (int round = 0; round < 1000; ++round)
      if (random() % 2 == 0)
        spread(order, gpus, count);
      else
        by_lead(order, gpus);
  }
}

TEST(Order, OfWorkOfTheLeadAloneCostsNoWaits) {
  Order order(4);
  FakeGpus gpus(4);
  for (int i = 0; i < 10; ++i) by_lead(order, gpus);
  EXPECT_EQ(gpus.waits(), 0);
  spread(order, gpus, 4);
  EXPECT_EQ(gpus.waits(), 3);
  by_lead(order, gpus);
  EXPECT_EQ(gpus.waits(), 6);
  by_lead(order, gpus);
  EXPECT_EQ(gpus.waits(), 6);
}

}  // namespace
}  // namespace pointskin::exec::gpus
