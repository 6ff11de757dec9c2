// What exec/space.hpp and exec/algorithms.hpp promise, against serial references, on any space.
#pragma once

#include <gtest/gtest.h>
#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exec/disjoint_sets.hpp"
#include "exec/exact_sum.hpp"
#include "support/spaces.hpp"

namespace pointskin::test {

/// Nothing, single elements, both sides of every block border (128: a CUDA block; 2048 and 65536: CPU blocks), many.
inline constexpr std::int64_t kSizes[] = {0, 1, 2, 127, 128, 129, 2047, 2048, 2049, 65535, 65536, 65537, 10'000'000};

inline std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

/// hash(seed + i) of the lowest `bits` bits, for i in [0, n).
inline std::vector<std::uint64_t> random_keys(std::int64_t n, std::uint64_t seed, int bits = 64) {
  std::vector<std::uint64_t> keys(index(n));
  for (std::int64_t i = 0; i < n; ++i) keys[index(i)] = hash(seed + static_cast<std::uint64_t>(i)) >> (64 - bits);
  return keys;
}

/// 0, 1, ..., n-1.
inline std::vector<std::int32_t> counted(std::int64_t n) {
  std::vector<std::int32_t> values(index(n));
  for (std::int64_t i = 0; i < n; ++i) values[index(i)] = static_cast<std::int32_t>(i);
  return values;
}

struct AddHash {
  ArrayView<std::uint64_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] += hash(static_cast<std::uint64_t>(i)); }
};

/// Keeps about `kept` of 8 indices.
struct KeepSome {
  std::uint64_t kept;
  PSK_HD bool operator()(std::int64_t i) const { return hash(static_cast<std::uint64_t>(i)) % 8 < kept; }
};

/// In (-1, 1); sums of such floats are rounded at nearly every step.
struct RandomFloat {
  PSK_HD float operator()(std::int64_t i) const {
    const auto bits = static_cast<std::int64_t>(hash(static_cast<std::uint64_t>(i)) >> 40);
    return static_cast<float>(bits - (1 << 23)) * 0x1p-23F;
  }
};
struct AddFloats {
  PSK_HD float operator()(float a, float b) const { return a + b; }
};

struct HashOf {
  PSK_HD std::uint64_t operator()(std::int64_t i) const { return hash(static_cast<std::uint64_t>(i)); }
};
/// Exact, so that a space may take it in any order.
struct AddExactly {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::uint64_t operator()(std::uint64_t a, std::uint64_t b) const { return a + b; }
};

/// Of both signs, from 2^-40 to 2^15 in size, all of them whole numbers of 2^-63.
struct MixedDouble {
  PSK_HD double operator()(std::int64_t i) const {
    const int exponent = static_cast<int>(hash(static_cast<std::uint64_t>(i) + 1) % 56) - 40;
    return std::ldexp(static_cast<double>(RandomFloat{}(i)), exponent);
  }
};
struct Constant {
  double value;
  PSK_HD double operator()(std::int64_t /*i*/) const { return value; }
};

/// out[i] = the sum of 8 random floats, 8 i and on.
struct SumByLanes {
  static constexpr int kLanes = 8;
  struct Sum {
    float value = 0;
    std::int32_t lanes = 0;
    PSK_HD Sum operator+(const Sum& other) const { return {value + other.value, lanes + other.lanes}; }
  };
  ArrayView<float> out;
  PSK_HD Sum part(std::int64_t i, int lane) const { return {RandomFloat{}(kLanes * i + lane), 1 << lane}; }
  PSK_HD void finish(std::int64_t i, const Sum& sum) const { out[i] = sum.lanes == (1 << kLanes) - 1 ? sum.value : -1; }
};

/// The tree that exec::reduce documents: lane l of max(1, n / 64) combines elements l, l + lanes, l + 2 lanes, ...;
/// then the same over the lanes, until one is left.
inline float documented_sum(std::int64_t n) {
  std::vector<float> values(index(n));
  for (std::int64_t i = 0; i < n; ++i) values[index(i)] = RandomFloat{}(i);
  do {
    const std::size_t lanes = std::max<std::size_t>(1, values.size() / 64);
    std::vector<float> sums(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(lanes));
    for (std::size_t i = lanes; i < values.size(); ++i) sums[i % lanes] += values[i];
    values = std::move(sums);
  } while (values.size() > 1);
  return values.front();
}

/// Expects `order` to be a permutation of [0, n) that puts `keys` in ascending order of their lowest `bits` bits, equal
/// ones in their old order. That (masked key, index) strictly ascends says all of it.
inline void expect_stable_order(const std::vector<std::uint64_t>& keys, const std::vector<std::int32_t>& order,
                                int bits) {
  ASSERT_EQ(order.size(), keys.size());
  const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  for (std::size_t i = 0; i < order.size(); ++i) {
    ASSERT_TRUE(order[i] >= 0 && index(order[i]) < keys.size()) << "at " << i;
    if (i == 0) continue;
    const std::pair before(keys[index(order[i - 1])] & mask, order[i - 1]);
    ASSERT_LT(before, std::pair(keys[index(order[i])] & mask, order[i])) << "at " << i << ", " << bits << " bits";
  }
}

template <exec::Space S>
void expect_sorted_pairs(S& ex, const std::vector<std::uint64_t>& keys, int bits) {
  auto device_keys = upload(ex, keys);
  auto values = upload(ex, counted(static_cast<std::int64_t>(keys.size())));
  sort_pairs(ex, "test", device_keys, values, bits);
  const std::vector<std::int32_t> order = to_host(ex, values);
  expect_stable_order(keys, order, bits);
  std::vector<std::uint64_t> expected;
  for (const std::int32_t i : order) expected.push_back(keys[index(i)]);
  expect_same(to_host(ex, device_keys), expected);
}

template <class S>
class Primitives : public OnSpace<S> {};
TYPED_TEST_SUITE_P(Primitives);

TYPED_TEST_P(Primitives, CallEveryIndexOnce) {
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    std::vector<std::uint64_t> expected = random_keys(n, 7);
    auto out = upload(this->space(), expected);
    for_each(this->space(), "test", n, AddHash{out.view()});
    for (std::int64_t i = 0; i < n; ++i) expected[index(i)] += hash(static_cast<std::uint64_t>(i));
    expect_same(to_host(this->space(), out), expected);
  }
}

TYPED_TEST_P(Primitives, SelectKeptIndicesInAscendingOrder) {
  for (const std::int64_t n : kSizes)
    for (const std::uint64_t kept : {0, 1, 7, 8}) {
      SCOPED_TRACE(::testing::Message() << n << " indices, " << kept << " of 8 kept");
      const KeepSome keep{kept};
      std::vector<std::int32_t> expected;
      for (std::int64_t i = 0; i < n; ++i)
        if (keep(i)) expected.push_back(static_cast<std::int32_t>(i));
      expect_same(to_host(this->space(), select(this->space(), "test", n, keep)), expected);
    }
}

/// Sums before every element, and the total behind them. Unsigned, so that overflow is defined.
template <class T>
std::vector<T> sums_before(const std::vector<T>& values) {
  std::vector<T> sums{T{}};
  for (const T value : values) sums.push_back(static_cast<T>(sums.back() + value));
  return sums;
}

TYPED_TEST_P(Primitives, ScanWithAndWithoutTheTotalAndInPlace) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    const std::vector<std::uint64_t> values = random_keys(n, 11);
    std::vector<std::uint64_t> expected = sums_before(values);
    auto in = upload(ex, values);
    auto with_total = exec::make_buffer<std::uint64_t>(ex, n + 1);
    exclusive_scan(ex, "test", in.cview(), with_total.view());
    expect_same(to_host(ex, with_total), expected);
    expected.pop_back();
    auto without = exec::make_buffer<std::uint64_t>(ex, n);
    exclusive_scan(ex, "test", in.cview(), without.view());
    expect_same(to_host(ex, without), expected);
    exclusive_scan(ex, "test", in.cview(), in.view());
    expect_same(to_host(ex, in), expected);
  }
}

TYPED_TEST_P(Primitives, ScanCountsOf32Bits) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    std::vector<std::int32_t> values(index(n));
    for (std::int64_t i = 0; i < n; ++i) values[index(i)] = static_cast<std::int32_t>(hash(index(i)) % 200);  // < 2^31
    auto in = upload(ex, values);
    auto out = exec::make_buffer<std::int32_t>(ex, n + 1);
    exclusive_scan(ex, "test", in.cview(), out.view());
    expect_same(to_host(ex, out), sums_before(values));
  }
}

TYPED_TEST_P(Primitives, SortPairsByAllBits) {
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    expect_sorted_pairs(this->space(), random_keys(n, 13), 64);
  }
}

TYPED_TEST_P(Primitives, SortPairsStably) {
  for (const std::int64_t n : kSizes) {  // 6 bits: 64 different keys
    SCOPED_TRACE(n);
    expect_sorted_pairs(this->space(), random_keys(n, 17, 6), 6);
  }
}

TYPED_TEST_P(Primitives, SortPairsByTheirLowestBitsAlone) {
  // The bits above are random and must not matter, also where `bits` is no multiple of the digits of a radix sort.
  for (const int bits : {1, 7, 8, 9, 12, 33, 63})
    for (const std::int64_t n : {2, 129, 2049, 65537}) {
      SCOPED_TRACE(n);
      expect_sorted_pairs(this->space(), random_keys(n, 19), bits);
    }
}

TYPED_TEST_P(Primitives, SortPairsWhoseKeysAgreeInSomeDigits) {
  for (const std::int64_t n : {1, 2, 65537}) {
    SCOPED_TRACE(n);
    std::vector<std::uint64_t> keys = random_keys(n, 23);
    for (std::uint64_t& key : keys) key = (key & 0x00ff00000000ff00) | 0x4200000000420000;
    expect_sorted_pairs(this->space(), keys, 64);
  }
}

TYPED_TEST_P(Primitives, SortKeys) {
  for (const int bits : {63, 12})
    for (const std::int64_t n : kSizes) {
      SCOPED_TRACE(n);
      std::vector<std::uint64_t> expected = random_keys(n, 29, bits);
      auto keys = upload(this->space(), expected);
      sort_keys(this->space(), "test", keys, bits);
      std::sort(expected.begin(), expected.end());
      expect_same(to_host(this->space(), keys), expected);
    }
}

TYPED_TEST_P(Primitives, SortKeysByTheirLowestBitsAlone) {
  constexpr int kBits = 12;
  std::vector<std::uint64_t> expected = random_keys(65537, 31);
  auto keys = upload(this->space(), expected);
  sort_keys(this->space(), "test", keys, kBits);
  const auto low = [](std::uint64_t key) { return key & ((1 << kBits) - 1); };
  std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return low(a) < low(b); });
  expect_same(to_host(this->space(), keys), expected);
}

TYPED_TEST_P(Primitives, CopyToTheSpaceWithinItAndBack) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    const std::vector<std::uint64_t> values = random_keys(n, 37);
    const auto there = upload(ex, values);
    auto twin = exec::make_buffer<std::uint64_t>(ex, n);
    copy(ex, there.cview(), twin.view());
    expect_same(to_host(ex, twin), values);
    if (n < 2) continue;  // and a part: all but the first and the last
    std::vector<std::uint64_t> inner(index(n - 2));
    copy_to_host(ex, there.cview().part(1, n - 2), inner.data());
    expect_same(inner, std::vector<std::uint64_t>(values.begin() + 1, values.end() - 1));
  }
}

TYPED_TEST_P(Primitives, FillGatherAndCount) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    const auto numbers = exec::iota(ex, n);
    expect_same(to_host(ex, numbers), counted(n));
    auto filled = exec::make_buffer<double>(ex, n);
    exec::fill(ex, filled.view(), 2.5);
    expect_same(to_host(ex, filled), std::vector<double>(index(n), 2.5));
    const std::vector<std::uint64_t> values = random_keys(n, 41);
    std::vector<std::int32_t> from(index(n));
    std::vector<std::uint64_t> expected(index(n));
    for (std::size_t i = 0; i < from.size(); ++i) {
      from[i] = static_cast<std::int32_t>(hash(i) % static_cast<std::uint64_t>(n));
      expected[i] = values[index(from[i])];
    }
    const auto in = upload(ex, values);
    auto out = exec::make_buffer<std::uint64_t>(ex, n);
    exec::gather(ex, in.cview(), upload(ex, from).cview(), out.view());
    expect_same(to_host(ex, out), expected);
  }
}

TYPED_TEST_P(Primitives, CallEveryIndexOfLongWorkOnce) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    auto out = exec::make_buffer<std::uint64_t>(ex, n);
    exec::fill(ex, out.view(), std::uint64_t{0});
    for_each_long(ex, "test", n, AddHash{out.view()});
    expect_same(to_host(ex, out), random_keys(n, 0));
  }
}

TYPED_TEST_P(Primitives, AddLanesInPairs) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    auto out = exec::make_buffer<float>(ex, n);
    for_each_by_lanes(ex, "test", n, SumByLanes{out.view()});
    std::vector<float> expected(index(n));
    for (std::int64_t i = 0; i < n; ++i) {
      const auto at = [&](std::int64_t lane) { return RandomFloat{}(8 * i + lane); };
      const float lower = (at(0) + at(1)) + (at(2) + at(3));
      const float upper = (at(4) + at(5)) + (at(6) + at(7));
      expected[index(i)] = lower + upper;
    }
    expect_same(to_host(ex, out), expected);
  }
}

TYPED_TEST_P(Primitives, ReduceByTheDocumentedTree) {
  for (const std::int64_t n : kSizes) {
    if (n == 0) continue;
    SCOPED_TRACE(n);
    EXPECT_EQ(exec::reduce<float>(this->space(), "test", n, RandomFloat{}, AddFloats{}), documented_sum(n));
  }
}

TYPED_TEST_P(Primitives, ReduceInAnyOrderWhatIsExact) {
  for (const std::int64_t n : kSizes) {
    if (n == 0) continue;
    SCOPED_TRACE(n);
    std::uint64_t expected = 0;
    for (std::int64_t i = 0; i < n; ++i) expected += HashOf{}(i);
    EXPECT_EQ(exec::reduce<std::uint64_t>(this->space(), "test", n, HashOf{}, AddExactly{}), expected);
  }
}

TYPED_TEST_P(Primitives, SumExactlyWhateverTheOrder) {
  for (const std::int64_t n : kSizes) {
    if (n == 0) continue;
    SCOPED_TRACE(n);
    exec::ExactSum backwards;
    for (std::int64_t i = n - 1; i >= 0; --i)
      backwards = exec::AddExactly{}(backwards, exec::exact_term(MixedDouble{}(i), 64));
    EXPECT_EQ(exec::exact_sum(this->space(), "test", n, MixedDouble{}, 64), backwards.value(64));
  }
}

TYPED_TEST_P(Primitives, SumExactlyWhatIsTooLargeForTheUnit) {
  EXPECT_EQ(exec::exact_sum(this->space(), "test", 1 << 20, Constant{0x1p300}, 64), 0x1p320);
  EXPECT_EQ(exec::exact_sum(this->space(), "test", 1 << 20, Constant{0x1p-300}, 64), 0x1p-280);
}

TYPED_TEST_P(Primitives, FindWhereRunsStart) {
  auto& ex = this->space();
  for (const std::int64_t n : kSizes) {
    SCOPED_TRACE(n);
    std::vector<std::uint64_t> keys(index(n));
    for (std::size_t i = 1; i < keys.size(); ++i) keys[i] = keys[i - 1] + (hash(i) % 4 == 0 ? 1 : 0);
    std::vector<std::int32_t> expected;
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (i == 0 || keys[i] != keys[i - 1]) expected.push_back(static_cast<std::int32_t>(i));
    expect_same(to_host(ex, exec::run_starts(ex, "test", upload(ex, keys).cview())), expected);
  }
}

TYPED_TEST_P(Primitives, SortUniqueLeavesEveryKeyOnce) {
  for (const std::int64_t n : kSizes) {  // 20 bits: about a million different keys
    SCOPED_TRACE(n);
    std::vector<std::uint64_t> expected = random_keys(n, 43, 20);
    const auto keys = exec::sort_unique(this->space(), "test", upload(this->space(), expected), 20);
    std::sort(expected.begin(), expected.end());
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    expect_same(to_host(this->space(), keys), expected);
  }
}

TYPED_TEST_P(Primitives, PoolsCountWhatIsHeldAndItsPeak) {
  auto& ex = this->space();
  const auto& pool = *ex.pool();
  const std::int64_t before = pool.held_bytes();
  auto a = exec::make_buffer<std::int32_t>(ex, 100);
  EXPECT_EQ(pool.held_bytes(), before + 400);
  auto b = exec::make_buffer<double>(ex, 1000);
  const auto nothing = exec::make_buffer<double>(ex, 0);
  EXPECT_EQ(nothing.data(), nullptr);
  EXPECT_EQ(pool.held_bytes(), before + 8400);
  a.reset();
  EXPECT_EQ(pool.held_bytes(), before + 8000);
  EXPECT_EQ(pool.peak_bytes(), before + 8400);
  ex.pool()->reset_peak();
  EXPECT_EQ(pool.peak_bytes(), before + 8000);
  b.reset();
  ex.pool()->trim();
  EXPECT_EQ(pool.held_bytes(), before);
  EXPECT_EQ(pool.peak_bytes(), before + 8000);
}

/// Expects an Error of over_limit from a request that no machine can meet, and the pool to be usable after it.
template <exec::Space S>
void expect_over_limit(S& ex, std::int64_t doubles) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers end the program on absurd requests";
#endif
  const std::int64_t before = ex.pool()->held_bytes();
  try {
    exec::make_buffer<double>(ex, doubles);
    ADD_FAILURE() << doubles << " doubles were allocated";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::over_limit) << error.what();
  }
  EXPECT_EQ(ex.pool()->held_bytes(), before);
  EXPECT_EQ(to_host(ex, upload(ex, counted(1000))), counted(1000));
}

TYPED_TEST_P(Primitives, MoreMemoryThanThereIsIsOverTheLimit) {
  expect_over_limit(this->space(), std::int64_t{1} << 57);  // 2^60 bytes
}

TYPED_TEST_P(Primitives, MoreBytesThan64BitsCountIsOverTheLimit) {
  expect_over_limit(this->space(), std::int64_t{1} << 61);  // 2^64 bytes
}

/// Joins i with another index of the same residue, chosen without structure.
struct UniteResidues {
  exec::DisjointSets sets;
  std::int64_t residues;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t n = sets.parents.size;
    const auto other = static_cast<std::int64_t>(hash(static_cast<std::uint64_t>(i)) % static_cast<std::uint64_t>(n));
    const std::int64_t same = other - other % residues + i % residues;
    const std::int64_t before = i - residues;
    if (same < n) sets.unite(static_cast<std::int32_t>(same), static_cast<std::int32_t>(i));
    if (before >= 0) sets.unite(static_cast<std::int32_t>(i), static_cast<std::int32_t>(before));
  }
};
struct StoreRoot {
  exec::DisjointSets sets;
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = sets.root(static_cast<std::int32_t>(i)); }
};

TYPED_TEST_P(Primitives, DisjointSetsEndAtTheirSmallestMembers) {
  auto& ex = this->space();
  for (const std::int64_t n : {1, 2, 129, 65'537, 1'000'000})
    for (const std::int64_t residues : {1, 2, 1000}) {
      const auto parents = exec::iota(ex, n);
      const exec::DisjointSets sets{parents.view()};
      for_each(ex, "test", n, UniteResidues{sets, residues});
      auto roots = exec::make_buffer<std::int32_t>(ex, n);
      for_each(ex, "test", n, StoreRoot{sets, roots.view()});
      std::vector<std::int32_t> expected = counted(n);
      for (std::int32_t& root : expected) root = static_cast<std::int32_t>(root % residues);
      expect_same(to_host(ex, roots), expected);
    }
}

/// All indices add to a few words.
struct AddHashes {
  ArrayView<std::uint64_t> words;
  PSK_HD void operator()(std::int64_t i) const {
    exec::add(words.data + i % words.size, hash(static_cast<std::uint64_t>(i)));
  }
};

TYPED_TEST_P(Primitives, AddToSharedWordsWithoutLosingAny) {
  auto& ex = this->space();
  constexpr std::int64_t kCount = 300'000;
  for (const std::int64_t words : {1, 7, 1000}) {
    auto sums = exec::make_buffer<std::uint64_t>(ex, words);
    exec::fill<std::uint64_t>(ex, sums.view(), 0);
    for_each(ex, "test", kCount, AddHashes{sums.view()});
    std::vector<std::uint64_t> expected(index(words));
    for (std::int64_t i = 0; i < kCount; ++i) expected[index(i % words)] += hash(static_cast<std::uint64_t>(i));
    expect_same(to_host(ex, sums), expected);
  }
}

/// Rounds of different sizes, from one array into the other: each index adds up three of the round before, near and far.
struct SumInRounds : exec::SweepAll {
  static constexpr int kRounds = 24;

  std::int32_t sizes[kRounds];
  std::uint64_t* from_to[2];  // all elements of both are set before

  [[nodiscard]] PSK_HD int indices(int round) const { return sizes[round]; }
  PSK_HD void operator()(int round, int i, Nothing) const {
    const std::uint64_t* from = from_to[round % 2];
    const std::int32_t last = sizes[round > 0 ? round - 1 : 0];
    from_to[1 - round % 2][i] = from[i % last] + 3 * from[(i + last / 2) % last] + from[last - 1 - i % last];
  }
};

TYPED_TEST_P(Primitives, SweepRoundsOfTheirOwnSizesOneAfterAnother) {
  auto& ex = this->space();
  for (const std::int32_t most : {1, 200, 257, 5'832, 39'304, 1'000'000}) {  // the last does not fit into one launch
    SCOPED_TRACE(most);
    SumInRounds sum{};
    for (int round = 0; round < SumInRounds::kRounds; ++round)
      sum.sizes[round] = std::max<std::int32_t>(1, most >> (3 * (round / 2 % 5)));
    std::vector<std::uint64_t> expected[2] = {random_keys(most, 3), random_keys(most, 5)};
    exec::Buffer<std::uint64_t> buffers[2] = {upload(ex, expected[0]), upload(ex, expected[1])};
    sum.from_to[0] = buffers[0].data();
    sum.from_to[1] = buffers[1].data();
    sweep(ex, "test", SumInRounds::kRounds, most, sum);
    sum.from_to[0] = expected[0].data();
    sum.from_to[1] = expected[1].data();
    for (int round = 0; round < SumInRounds::kRounds; ++round)
      for (int i = 0; i < sum.sizes[round]; ++i) sum(round, i, {});
    expect_same(to_host(ex, buffers[0]), expected[0]);
    expect_same(to_host(ex, buffers[1]), expected[1]);
  }
}

TYPED_TEST_P(Primitives, ReadWhatTheWorkBeforeHasWritten) {
  auto& ex = this->space();
  constexpr std::int64_t kCount = 2'000'000;  // takes longer than the copy
  auto words = exec::make_buffer<std::uint64_t>(ex, kCount);
  exec::fill<std::uint64_t>(ex, words.view(), 0);
  std::uint64_t expected = 0;
  for (int round = 0; round < 50; ++round) {
    for_each(ex, "test", kCount, AddHash{words.view()});
    expected += hash(static_cast<std::uint64_t>(kCount - 1));
    ASSERT_EQ(exec::read_element(ex, words.cview(), kCount - 1), expected);
    std::vector<std::uint64_t> some(512);  // as much as is staged
    copy_to_host(ex, ArrayView<const std::uint64_t>(words.view().part(kCount - 512, 512)), some.data());
    ASSERT_EQ(some.back(), expected);
  }
}

TYPED_TEST_P(Primitives, BuffersMoveTheirMemoryAndKeepTheirPool) {
  auto& ex = this->space();
  exec::Buffer<std::int32_t> a = upload(ex, counted(100));
  const std::int32_t* data = a.data();
  exec::Buffer<std::int32_t> b = std::move(a);
  EXPECT_EQ(b.data(), data);
  EXPECT_EQ(b.size(), 100);
  EXPECT_TRUE(a.empty());  // NOLINT(bugprone-use-after-move): moved-from buffers are empty
  EXPECT_EQ(a.data(), nullptr);
  exec::Buffer<std::int32_t> c = upload(ex, counted(7));
  const std::int64_t held = ex.pool()->held_bytes();
  c = std::move(b);  // frees the 7
  EXPECT_EQ(c.data(), data);
  EXPECT_EQ(ex.pool()->held_bytes(), held - 28);
  auto& same = c;
  c = std::move(same);
  EXPECT_EQ(to_host(ex, c), counted(100));
  exec::Buffer<std::int32_t> survivor;
  std::weak_ptr<exec::MemoryPool> pool;
  {
    auto other = SpaceUnderTest<TypeParam>::open();
    survivor = upload(*other, counted(10));
    pool = other->pool();
  }
  EXPECT_FALSE(pool.expired());
  survivor.reset();
  EXPECT_TRUE(pool.expired());
}

REGISTER_TYPED_TEST_SUITE_P(Primitives, CallEveryIndexOnce, CallEveryIndexOfLongWorkOnce, AddLanesInPairs,
                            SelectKeptIndicesInAscendingOrder, ScanWithAndWithoutTheTotalAndInPlace, ScanCountsOf32Bits,
                            SortPairsByAllBits, SortPairsStably, SortPairsByTheirLowestBitsAlone,
                            SortPairsWhoseKeysAgreeInSomeDigits, SortKeys, SortKeysByTheirLowestBitsAlone,
                            CopyToTheSpaceWithinItAndBack, FillGatherAndCount, ReduceByTheDocumentedTree,
                            ReduceInAnyOrderWhatIsExact, SumExactlyWhateverTheOrder, SumExactlyWhatIsTooLargeForTheUnit,
                            FindWhereRunsStart, SortUniqueLeavesEveryKeyOnce, DisjointSetsEndAtTheirSmallestMembers,
                            AddToSharedWordsWithoutLosingAny, SweepRoundsOfTheirOwnSizesOneAfterAnother,
                            ReadWhatTheWorkBeforeHasWritten, PoolsCountWhatIsHeldAndItsPeak,
                            MoreMemoryThanThereIsIsOverTheLimit, MoreBytesThan64BitsCountIsOverTheLimit,
                            BuffersMoveTheirMemoryAndKeepTheirPool);

}  // namespace pointskin::test
