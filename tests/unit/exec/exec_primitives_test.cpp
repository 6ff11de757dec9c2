// The primitives on the CPU: the bodies that all spaces share, and what only threads can get wrong.
#include "unit/exec/primitives_tests.hpp"

#include <pointskin/cancel.hpp>
#include <pointskin/error.hpp>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <stdexcept>
#include <string>

#include "exec/cpu_threads.hpp"
#include "exec/host_array.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnCpu, Primitives, CpuSpaces);

namespace {

constexpr int kThreads[] = {1, 2, 5, 16};
constexpr std::uint64_t kSentinel = 0x5e7713e1;

/// One result of every primitive over n elements.
struct Results {
  std::vector<std::uint64_t> mapped, scanned, sorted_keys, unique;
  std::vector<std::int32_t> selected, order;
  float sum = 0;
  friend bool operator==(const Results&, const Results&) = default;
};

Results run_all(int threads, std::int64_t n) {
  exec::Cpu ex(threads);
  EXPECT_EQ(ex.threads(), threads);
  Results results;
  auto values = upload(ex, random_keys(n, 47, 20));
  for_each(ex, "test", n, AddHash{values.view()});
  results.mapped = to_host(ex, values);
  results.selected = to_host(ex, select(ex, "test", n, KeepSome{3}));
  auto scanned = exec::make_buffer<std::uint64_t>(ex, n + 1);
  exclusive_scan(ex, "test", values.cview(), scanned.view());
  results.scanned = to_host(ex, scanned);
  auto order = exec::iota(ex, n);
  auto keys = upload(ex, random_keys(n, 53, 16));
  sort_pairs(ex, "test", keys, order, 16);
  results.order = to_host(ex, order);
  sort_keys(ex, "test", values, 64);
  results.sorted_keys = to_host(ex, values);
  results.unique = to_host(ex, exec::sort_unique(ex, "test", std::move(keys), 16));
  results.sum = exec::reduce<float>(ex, "test", n, RandomFloat{}, AddFloats{});
  return results;
}

TEST(CpuThreads, AreAtMost256UnlessTheMachineHasMore) {
  EXPECT_LE(exec::Cpu(100'000).threads(), std::max<int>(256, exec::Cpu().threads()));
  EXPECT_EQ(exec::threads_that_can_be_made(1, 8), 1);
  EXPECT_GE(exec::threads_that_can_be_made(3, 1), 1);
}

/// Runs work() and tells how it ended.
template <class Work>
ErrorCode code_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode{};
}

TEST(CancelScope, StopsWorkWithinTheNextFewHundredIndices) {
  constexpr std::int64_t kIndices = 10'000'000;
  constexpr std::int64_t kUntil = 5'000;
  for (const int threads : {1, 3}) {
    exec::Cpu ex(threads);
    std::atomic<bool> stop{false};
    std::atomic<std::int64_t> calls{0};
    const auto count = [&](std::int64_t /*i*/) {
      if (++calls == kUntil) stop = true;
    };
    const CancelScope scope(stop);
    EXPECT_EQ(code_of([&] { for_each(ex, "test", kIndices, count); }), ErrorCode::interrupted);
    EXPECT_LE(calls, kUntil + threads * exec::kCancelBlock) << threads;
  }
}

TEST(CancelScope, BeginsNothingOnceTheFlagIsSet) {
  exec::Cpu ex(2);
  const std::atomic<bool> stop{true};
  std::atomic<std::int64_t> calls{0};
  const auto count = [&](std::int64_t /*i*/) { ++calls; };
  {
    const CancelScope scope(stop);
    EXPECT_EQ(code_of([&] { for_each(ex, "test", 100'000, count); }), ErrorCode::interrupted);
    EXPECT_EQ(code_of([&] { (void)select(ex, "test", 100'000, [](std::int64_t) { return true; }); }),
              ErrorCode::interrupted);
    const std::atomic<bool> never{false};
    const CancelScope inner(never);
    EXPECT_NO_THROW(for_each(ex, "test", 10, count));
  }
  EXPECT_EQ(calls, 10);
  EXPECT_NO_THROW(for_each(ex, "test", 10, count));
  EXPECT_EQ(calls, 20);
}

TEST(MemoryPool, HoldsTheTighterOfTheTwoLimits) {
  exec::Cpu ex(1);
  ex.pool()->set_lasting_limit(1000);
  EXPECT_EQ(ex.pool()->limit(), 1000);
  ex.pool()->set_limit(2000);
  EXPECT_EQ(ex.pool()->limit(), 1000);
  ex.pool()->set_limit(500);
  EXPECT_EQ(ex.pool()->limit(), 500);
  ex.pool()->set_limit(0);
  EXPECT_EQ(code_of([&] { (void)exec::make_buffer<char>(ex, 1001); }), ErrorCode::over_limit);
  ex.pool()->set_lasting_limit(0);
  EXPECT_NO_THROW((void)exec::make_buffer<char>(ex, 1001));
}

TEST(PrimitivesOnThreads, GiveTheSameBitsForAnyNumberOfThreads) {
  for (const std::int64_t n : {1, 63, 2049, 65537, 1'000'000}) {
    const Results expected = run_all(1, n);
    for (const int threads : kThreads) EXPECT_TRUE(run_all(threads, n) == expected) << threads << " threads, n = " << n;
  }
}

TEST(PrimitivesOnThreads, RunEveryBlockOnce) {
  for (const int threads : kThreads) {
    exec::Cpu ex(threads);
    for (const std::int64_t blocks : {0, 1, 2, 1000}) {
      std::vector<std::atomic<int>> calls(index(blocks));
      ex.run_blocks(blocks, [&](std::int64_t b) { ++calls[index(b)]; });
      for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1);
    }
  }
}

TEST(PrimitivesOnThreads, AskAPredicateOncePerIndex) {
  for (const int threads : kThreads) {
    exec::Cpu ex(threads);
    for (const std::int64_t n : {0, 1, 63, 64, 65, 2047, 2048, 2049, 100'000}) {
      std::vector<std::atomic<int>> calls(index(n));
      const auto kept = to_host(ex, select(ex, "test", n, [&](std::int64_t i) {
                                  ++calls[index(i)];
                                  return i % 3 == 0;
                                }));
      for (const std::atomic<int>& count : calls) ASSERT_EQ(count, 1);
      ASSERT_EQ(kept.size(), index((n + 2) / 3));
      for (std::size_t k = 0; k < kept.size(); ++k) ASSERT_EQ(kept[k], static_cast<std::int32_t>(3 * k));
    }
  }
}

TEST(PrimitivesOnThreads, CopyArraysOfAnySize) {
  for (const int threads : kThreads) {
    exec::Cpu ex(threads);
    for (const std::int64_t n : {0, 1, 32767, 32768, 32769, 100'000}) {
      const std::vector<std::uint64_t> from = random_keys(n, 59, 64);
      const auto there = upload(ex, from);
      auto copied = exec::make_buffer<std::uint64_t>(ex, n + 1);
      copy_to_device(ex, &kSentinel, copied.view().part(n, 1));
      copy(ex, there.cview(), copied.view());
      std::vector<std::uint64_t> expected = from;
      expected.push_back(kSentinel);
      expect_same(to_host(ex, copied), expected);
    }
  }
}

TEST(PrimitivesOnThreads, SortAtTheBordersOfBlocks) {
  for (const int threads : {1, 4})
    for (const std::int64_t n : {0, 1, 4095, 4096, 4097, 262'145, 500'001}) {
      exec::Cpu ex(threads);
      const std::vector<std::uint64_t> from = random_keys(n, 61, 11);
      auto keys = upload(ex, from);
      auto order = exec::iota(ex, n);
      sort_pairs(ex, "test", keys, order, 11);
      std::vector<std::int32_t> expected = counted(n);
      std::stable_sort(expected.begin(), expected.end(),
                       [&](std::int32_t a, std::int32_t b) { return from[index(a)] < from[index(b)]; });
      expect_same(to_host(ex, order), expected);
    }
}

struct ThrowAt {
  std::int64_t from, end;
  void operator()(std::int64_t i) const {
    if (i >= from && i < end) throw std::runtime_error("index " + std::to_string(i));
  }
};

TEST(PrimitivesOnThreads, BringExceptionsToTheCaller) {
  constexpr std::int64_t kCount = 100'000;
  for (const int threads : kThreads) {
    exec::Cpu ex(threads);
    for (const ThrowAt& thrower : {ThrowAt{77'777, 77'778}, ThrowAt{0, kCount}}) {
      try {
        for_each(ex, "test", kCount, thrower);
        ADD_FAILURE() << "no exception with " << threads << " threads";
      } catch (const std::runtime_error& error) {
        const bool one_throws = thrower.end == thrower.from + 1;
        const std::string expected = one_throws ? "index 77777" : "index ";
        EXPECT_EQ(std::string(error.what()).substr(0, expected.size()), expected);
      }
    }
    EXPECT_THROW(for_each(ex, "test", 1, ThrowAt{0, 1}), std::runtime_error);
    EXPECT_EQ(to_host(ex, exec::iota(ex, kCount)), counted(kCount)) << "the space must still work";
  }
}

TEST(CpuSpace, RefusesANegativeNumberOfThreads) {
  try {
    exec::Cpu ex(-1);
    ADD_FAILURE() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
  }
}

TEST(CpuSpace, TakesAllThreadsForZero) { EXPECT_GE(exec::Cpu(0).threads(), 1); }

TEST(CpuPool, ReusesFreedBlocksForRequestsOfAboutTheirSize) {
  exec::Cpu ex(1);
  auto block = exec::make_buffer<char>(ex, 1'000'000);
  const char* data = block.data();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(data) % 256, 0U);
  block.reset();
  block = exec::make_buffer<char>(ex, 1'000'000);
  EXPECT_EQ(block.data(), data);
  block.reset();
  // Four size classes per octave: (917504, 1048576] is one of them.
  block = exec::make_buffer<char>(ex, 950'000);
  EXPECT_EQ(block.data(), data);
  const auto other = exec::make_buffer<char>(ex, 1'000'000);
  EXPECT_NE(other.data(), data) << "in use";
}

TEST(CpuPool, AlignsEveryBlock) {
  exec::Cpu ex(1);
  std::vector<exec::Buffer<char>> blocks;
  for (std::int64_t size = 1; size < 200'000; size = size * 3 / 2 + 1) {
    blocks.push_back(exec::make_buffer<char>(ex, size));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(blocks.back().data()) % 256, 0U) << size;
    blocks.back().data()[size - 1] = 1;  // for the address sanitizer
  }
}

/// Buffers of random sizes, small and large, taken and freed in random order; each keeps its bytes while it lives.
TEST(CpuPool, NeverHandsOutMemoryThatIsInUse) {
  exec::Cpu ex(1);
  std::vector<exec::Buffer<std::uint64_t>> live;
  for (std::uint64_t step = 0; step < 2000; ++step) {
    const std::uint64_t dice = hash(step);
    if (live.size() > 20 || (dice % 3 == 0 && !live.empty())) {
      exec::Buffer<std::uint64_t>& victim = live[(dice >> 8) % live.size()];
      const std::uint64_t mark = victim.data()[0];
      for (std::int64_t i = 0; i < victim.size(); i += 256) ASSERT_EQ(victim.data()[i], mark) << "step " << step;
      ASSERT_EQ(victim.data()[victim.size() - 1], mark) << "step " << step;
      victim.swap(live.back());
      live.pop_back();
      continue;
    }
    const auto size = static_cast<std::int64_t>(1 + (dice >> 20) % (std::uint64_t{1} << (4 + (dice >> 8) % 17)));
    auto block = exec::make_buffer<std::uint64_t>(ex, size);
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(block.data()) % 256, 0U);
    for (std::int64_t i = 0; i < size; i += 256) block.data()[i] = step;
    block.data()[size - 1] = step;
    live.push_back(std::move(block));
  }
}

TEST(CpuPool, CutsBlocksFromAFreedLargerOneAndMergesThemAgain) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "blocks are not cut under the address sanitizer";
#endif
  constexpr std::int64_t kLarge = 8 << 20;
  exec::Cpu ex(1);
  auto whole = exec::make_buffer<char>(ex, kLarge);
  const char* data = whole.data();
  whole.reset();
  auto first = exec::make_buffer<char>(ex, kLarge / 4);
  auto second = exec::make_buffer<char>(ex, kLarge / 2);
  auto third = exec::make_buffer<char>(ex, kLarge / 4);
  for (const exec::Buffer<char>* part : {&first, &second, &third}) {
    EXPECT_GE(part->data(), data);
    EXPECT_LE(part->data() + part->size(), data + kLarge);
  }
  first.reset();
  third.reset();
  second.reset();
  EXPECT_EQ(exec::make_buffer<char>(ex, kLarge).data(), data);
}

/// Bytes of this process that are in memory now.
std::int64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t all = 0;
  std::int64_t resident = 0;
  statm >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

TEST(SpacesOfACpu, LeaveNothingBehindWhenTheyGo) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep memory for a while";
#endif
  const auto make_some = [] {
    for (int i = 0; i < 1000; ++i) {
      exec::Cpu ex(2);
      std::atomic<std::int64_t> sum{0};
      ex.run_blocks(64, [&](std::int64_t block) { sum += block; });
      ASSERT_EQ(sum, 64 * 63 / 2);
    }
  };
  make_some();
  const std::int64_t before = resident_bytes();
  make_some();
  EXPECT_LT(resident_bytes(), before + (std::int64_t{1} << 20));
}

TEST(PoolOfACpu, HoldsNoMoreThanItsLimit) {
  constexpr std::int64_t kMiB = std::int64_t{1} << 20;
  exec::Cpu ex(2);
  ex.pool()->set_limit(4 * kMiB);
  auto first = exec::make_buffer<char>(ex, 3 * kMiB);
  EXPECT_NO_THROW((void)exec::make_buffer<char>(ex, kMiB));
  try {
    (void)exec::make_buffer<char>(ex, kMiB + 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::over_limit);
  }
  EXPECT_EQ(ex.pool()->held_bytes(), 3 * kMiB);
  first.reset();
  EXPECT_NO_THROW((void)exec::make_buffer<char>(ex, kMiB + 1));
  ex.pool()->set_limit(0);
  EXPECT_NO_THROW((void)exec::make_buffer<char>(ex, 16 * kMiB));
}

TEST(PoolOfACpu, CachesNothingBeyondItsLimit) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer watches blocks of malloc, which are not given up one by one";
#endif
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer holds two bytes in memory for each that is written";
#endif
  constexpr std::int64_t kMiB = std::int64_t{1} << 20;
  exec::Cpu ex(2);
  const std::int64_t before = resident_bytes();
  ex.pool()->set_limit(48 * kMiB);
  for (const std::int64_t size : {16, 20, 24, 28, 32, 36, 40, 44}) {  // none fits where the one before it was
    auto low = exec::make_buffer<char>(ex, kMiB);
    auto block = exec::make_buffer<char>(ex, size * kMiB);
    exec::fill(ex, block.view(), 'x');
    low.reset();
    low = exec::make_buffer<char>(ex, 2 * kMiB);
    exec::fill(ex, low.view(), 'x');
    EXPECT_LE(resident_bytes() - before, 49 * kMiB) << size;
  }
}

TEST(PoolOfACpu, GivesUpWhatItCachesForVectorsOfTheHost) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer watches blocks of malloc, which are not given up one by one";
#endif
  constexpr std::int64_t kBytes = std::int64_t{64} << 20;
  exec::Cpu ex(2);
  {
    auto block = exec::make_buffer<char>(ex, kBytes);
    exec::fill(ex, block.view(), 'x');
  }
  const std::int64_t cached = resident_bytes();
  std::vector<char> values;
  exec::resize(ex, values, static_cast<std::size_t>(kBytes));
  EXPECT_LT(resident_bytes(), cached + kBytes / 4);
}

}  // namespace
}  // namespace pointskin::test
