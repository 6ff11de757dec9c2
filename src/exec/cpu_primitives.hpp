// The data-parallel primitives on the CPU. Blocks depend on the range alone: same result for any number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cancel.hpp"
#include "exec/cpu.hpp"
#include "exec/lanes.hpp"
#include "exec/memory.hpp"
#include "exec/reduce_order.hpp"
#include "exec/sweep.hpp"
#include "exec/wide.hpp"

namespace pointskin::exec {

/// Indices per block of for_each, select and scan: large enough to hide the scheduling, small enough to balance.
inline constexpr std::int64_t kCpuBlock = 2048;

/// Elements per block of the radix sort: blocks for many threads, but few enough that their histograms stay small
/// beside the keys.
inline std::int64_t cpu_sort_block(std::int64_t n) { return std::clamp<std::int64_t>(n / 64, 1 << 12, 1 << 16); }

/// Indices of for_each between two looks at the flag of a CancelScope: some functors take a millisecond an index.
inline constexpr std::int64_t kCancelBlock = 256;

inline std::int64_t block_count(std::int64_t n, std::int64_t block) { return (n + block - 1) / block; }

/// Calls f(i) for every i in [0, n). f must not depend on the order of the calls. Functors with a `wide` body use it
/// where the processor has AVX2 (exec/wide.hpp).
template <class F>
void for_each(Cpu& ex, const char* /*label*/, std::int64_t n, const F& f) {
  if (n <= 0) return;
  // Heavy functors over few indices still spread over the threads.
  const std::int64_t block = std::clamp<std::int64_t>(n / 64, 16, kCpuBlock);
  const std::atomic<bool>* const cancelled = cancel_flag();
  ex.run_blocks(block_count(n, block), [&](std::int64_t b) {
    const std::int64_t end = std::min(n, (b + 1) * block);
    for (std::int64_t i = b * block; i < end; i += kCancelBlock) {
      throw_if_cancelled(cancelled);
      run_range(f, i, std::min(end, i + kCancelBlock));
    }
  });
}

inline int lanes_apart(const Cpu& /*ex*/, std::int64_t /*n*/) { return 1; }

/// The same: on a CPU an index has its thread to itself.
template <class F>
void for_each_apart(Cpu& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, f);
}

/// The same: on a CPU indices are shared out in blocks however many they are.
template <class F>
void for_each_long(Cpu& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, f);
}

/// Calls f.finish(i, sum of its parts) for every i in [0, n); see exec/lanes.hpp.
template <class F>
void for_each_by_lanes(Cpu& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, SumOfLanes<F>{f});
}

/// Calls f(round, i, f.prepare(i)) for every i in [0, n) with f.takes_part(i) and every round in [0, rounds), rounds
/// one after another.
template <class F>
void sweep(Cpu& ex, const char* label, int rounds, std::int64_t n, const F& f) {
  for (int round = 0; round < rounds; ++round)
    for_each(ex, label, indices_of_round(f, round, static_cast<int>(n)), SweepRound<F>{f, round});
}

/// out[0] = the combination of at most kReduceTail values, in the order of exec::reduce.
template <class T, class Combine>
void reduce_tail(Cpu& /*ex*/, const char* /*label*/, ArrayView<const T> values, ArrayView<T> out,
                 const Combine& combine) {
  std::vector<T> sums(values.begin(), values.end());
  while (sums.size() > 1) {
    const auto n = static_cast<std::int64_t>(sums.size());
    std::vector<T> fewer(static_cast<std::size_t>(reduce_lanes(n)));
    for (std::size_t lane = 0; lane < fewer.size(); ++lane)
      fewer[lane] = combine_lane(LoadValue<T>{{sums.data(), n}}, combine, n, static_cast<std::int64_t>(fewer.size()),
                                 static_cast<std::int64_t>(lane));
    sums = std::move(fewer);
  }
  out[0] = sums.front();
}

namespace detail {

inline constexpr std::int64_t kBitsPerWord = 64;
static_assert(kCpuBlock % kBitsPerWord == 0);

/// Bit k of the result is keep(first + k), for first + k < end. Without branches: a predicate need not be predictable.
template <class Keep>
std::uint64_t kept_bits(std::int64_t first, std::int64_t end, const Keep& keep) {
  std::uint64_t bits = 0;
  const std::int64_t count = std::min<std::int64_t>(kBitsPerWord, end - first);
  for (std::int64_t k = 0; k < count; ++k) bits |= std::uint64_t{keep(first + k) ? 1U : 0U} << k;
  return bits;
}

}  // namespace detail

/// The indices i in [0, n) with keep(i), ascending. One call of keep per index; O(n), n bits of scratch.
template <class Keep>
Buffer<std::int32_t> select(Cpu& ex, const char* /*label*/, std::int64_t n, const Keep& keep) {
  constexpr std::int64_t kWords = kCpuBlock / detail::kBitsPerWord;  // of a block
  const std::int64_t words = block_count(n, detail::kBitsPerWord);
  const std::int64_t blocks = block_count(n, kCpuBlock);
  Buffer<std::uint64_t> bits(ex.pool(), words);
  std::vector<std::int64_t> first(static_cast<std::size_t>(blocks) + 1, 0);
  const std::atomic<bool>* const cancelled = cancel_flag();
  ex.run_blocks(blocks, [&](std::int64_t b) {
    std::int64_t count = 0;
    for (std::int64_t w = b * kWords; w < std::min(words, (b + 1) * kWords); ++w) {
      throw_if_cancelled(cancelled);
      bits.data()[w] = detail::kept_bits(w * detail::kBitsPerWord, n, keep);
      count += std::popcount(bits.data()[w]);
    }
    first[static_cast<std::size_t>(b) + 1] = count;
  });
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  Buffer<std::int32_t> kept(ex.pool(), first.back());
  ex.run_blocks(blocks, [&](std::int64_t b) {
    std::int32_t* out = kept.data() + first[static_cast<std::size_t>(b)];
    for (std::int64_t w = b * kWords; w < std::min(words, (b + 1) * kWords); ++w)
      for (std::uint64_t left = bits.data()[w]; left != 0; left &= left - 1)
        *out++ = static_cast<std::int32_t>(w * detail::kBitsPerWord + std::countr_zero(left));
  });
  return kept;
}

/// out[i] = in[0] + ... + in[i-1]; out.size is in.size (in place allowed) or in.size + 1 (the last is the total). O(n).
template <class T>
void exclusive_scan(Cpu& ex, const char* /*label*/, ArrayView<const T> in, ArrayView<T> out) {
  const std::int64_t blocks = block_count(in.size, kCpuBlock);
  std::vector<T> first(static_cast<std::size_t>(blocks) + 1, T{});
  ex.run_blocks(blocks, [&](std::int64_t b) {
    T sum{};
    for (std::int64_t i = b * kCpuBlock; i < std::min(in.size, (b + 1) * kCpuBlock); ++i) sum += in[i];
    first[static_cast<std::size_t>(b) + 1] = sum;
  });
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  ex.run_blocks(blocks, [&](std::int64_t b) {
    T sum = first[static_cast<std::size_t>(b)];
    for (std::int64_t i = b * kCpuBlock; i < std::min(in.size, (b + 1) * kCpuBlock); ++i) {
      const T value = in[i];
      out[i] = sum;
      sum += value;
    }
  });
  if (out.size > in.size) out[in.size] = first.back();
}

namespace detail {

inline constexpr int kDigitBits = 8;
inline constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
using Histogram = std::array<std::int64_t, kDigits>;

/// The bits of the key that one pass sorts by.
struct Digit {
  int shift;
  std::size_t mask;
  /// @param bits  of the whole key: the last digit may be narrower
  Digit(int first_bit, int bits)
      : shift(first_bit), mask((std::size_t{1} << std::min(kDigitBits, bits - first_bit)) - 1) {}
  std::size_t operator()(std::uint64_t key) const { return key >> shift & mask; }
};

/// One stable counting pass over a digit: calls move(from, to) for every element.
/// @returns false, nothing moved, if all keys share that digit
template <class Move>
bool sort_pass(Cpu& ex, const Digit& digit_of, ArrayView<const std::uint64_t> keys, std::vector<Histogram>& offsets,
               const Move& move) {
  const std::int64_t n = keys.size;
  const std::int64_t block = cpu_sort_block(n);
  const auto blocks = static_cast<std::int64_t>(offsets.size());
  ex.run_blocks(blocks, [&](std::int64_t b) {
    Histogram& count = offsets[static_cast<std::size_t>(b)];
    count.fill(0);
    for (std::int64_t i = b * block; i < std::min(n, (b + 1) * block); ++i) ++count[digit_of(keys[i])];
  });
  // Row by row, so that the sums are vectorised: counts become offsets from the first element of their digit.
  Histogram first{};
  for (Histogram& count : offsets)
    for (std::size_t digit = 0; digit < kDigits; ++digit) first[digit] += std::exchange(count[digit], first[digit]);
  if (std::find(first.begin(), first.end(), n) != first.end()) return false;
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::int64_t{0});
  ex.run_blocks(blocks, [&](std::int64_t b) {
    Histogram& offset = offsets[static_cast<std::size_t>(b)];
    for (std::size_t digit = 0; digit < kDigits; ++digit) offset[digit] += first[digit];
    for (std::int64_t i = b * block; i < std::min(n, (b + 1) * block); ++i) move(i, offset[digit_of(keys[i])]++);
  });
  return true;
}

}  // namespace detail

/// Sorts (key, value) pairs by bits [first_bit, bits) of the keys, ascending and stable. Least significant digit first,
/// 8 bits a pass, passes in which all keys agree are skipped. O(n (bits - first_bit) / 8); n pairs of scratch.
template <class Value>
void sort_pairs(Cpu& ex, const char* /*label*/, Buffer<std::uint64_t>& keys, Buffer<Value>& values, int bits,
                int first_bit = 0) {
  const std::int64_t n = keys.size();
  Buffer<std::uint64_t> other_keys(ex.pool(), n);
  Buffer<Value> other_values(ex.pool(), n);
  std::vector<detail::Histogram> offsets(static_cast<std::size_t>(block_count(n, cpu_sort_block(n))));
  for (int shift = first_bit; shift < bits; shift += detail::kDigitBits) {
    const auto move = [&](std::int64_t from, std::int64_t to) {
      other_keys.data()[to] = keys.data()[from];
      other_values.data()[to] = values.data()[from];
    };
    if (detail::sort_pass(ex, detail::Digit(shift, bits), keys.cview(), offsets, move)) {
      keys.swap(other_keys);
      values.swap(other_values);
    }
  }
}

/// Sorts keys alone, by their lowest `bits` bits; otherwise as sort_pairs.
inline void sort_keys(Cpu& ex, const char* /*label*/, Buffer<std::uint64_t>& keys, int bits) {
  Buffer<std::uint64_t> other(ex.pool(), keys.size());
  std::vector<detail::Histogram> offsets(
      static_cast<std::size_t>(block_count(keys.size(), cpu_sort_block(keys.size()))));
  for (int shift = 0; shift < bits; shift += detail::kDigitBits) {
    const auto move = [&](std::int64_t from, std::int64_t to) { other.data()[to] = keys.data()[from]; };
    if (detail::sort_pass(ex, detail::Digit(shift, bits), keys.cview(), offsets, move)) keys.swap(other);
  }
}

/// Copies `from` to the first elements of `to`, in parallel blocks of about 256 KiB. The two must not overlap.
template <class T>
void copy(Cpu& ex, ArrayView<const T> from, ArrayView<T> to) {
  static_assert(std::is_trivially_copyable_v<T>);
  constexpr std::int64_t kBlock =
      std::max<std::int64_t>(1, (std::int64_t{1} << 18) / static_cast<std::int64_t>(sizeof(T)));
  ex.run_blocks(block_count(from.size, kBlock), [&](std::int64_t b) {
    const std::int64_t count = std::min(kBlock, from.size - b * kBlock);
    std::memcpy(to.data + b * kBlock, from.data + b * kBlock, static_cast<std::size_t>(count) * sizeof(T));
  });
}

template <class T>
void copy_to_host(Cpu& ex, ArrayView<const T> from, T* to) {
  copy(ex, from, ArrayView<T>{to, from.size});
}

template <class T>
void copy_constant_to_device(Cpu& ex, const T* from, ArrayView<T> to) {
  copy(ex, ArrayView<const T>{from, to.size}, to);
}

template <class T>
void copy_to_device(Cpu& ex, const T* from, ArrayView<T> to) {
  copy(ex, ArrayView<const T>{from, to.size}, to);
}

}  // namespace pointskin::exec
