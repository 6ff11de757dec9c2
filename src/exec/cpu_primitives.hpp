// The data-parallel primitives on the CPU. Blocks depend on the range alone: same result for any number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "exec/reduce_order.hpp"

namespace pointskin::exec {

/// Indices per block of for_each, select and scan: large enough to hide the scheduling, small enough to balance.
inline constexpr std::int64_t kCpuBlock = 2048;

/// Elements per block of the radix sort.
inline constexpr std::int64_t kCpuSortBlock = 1 << 16;

inline std::int64_t block_count(std::int64_t n, std::int64_t block) { return (n + block - 1) / block; }

/// Calls f(i) for every i in [0, n). f must not depend on the order of the calls.
template <class F>
void for_each(Cpu& ex, const char* /*label*/, std::int64_t n, const F& f) {
  if (n <= 0) return;
  // Heavy functors over few indices still spread over the threads.
  const std::int64_t block = std::clamp<std::int64_t>(n / 64, 16, kCpuBlock);
  ex.run_blocks(block_count(n, block), [&](std::int64_t b) {
    const std::int64_t end = std::min(n, (b + 1) * block);
    for (std::int64_t i = b * block; i < end; ++i) f(i);
  });
}

/// Calls f(round, i, f.prepare(i)) for every i in [0, n) with f.takes_part(i) and every round in [0, rounds), rounds one
/// after another.
template <class F>
void sweep(Cpu& ex, const char* label, int rounds, std::int64_t n, const F& f) {
  for (int round = 0; round < rounds; ++round) for_each(ex, label, n, SweepRound<F>{f, round});
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

/// The indices i in [0, n) with keep(i), ascending. Two passes over keep; O(n).
template <class Keep>
Buffer<std::int32_t> select(Cpu& ex, const char* /*label*/, std::int64_t n, const Keep& keep) {
  const std::int64_t blocks = block_count(n, kCpuBlock);
  std::vector<std::int64_t> first(static_cast<std::size_t>(blocks) + 1, 0);
  ex.run_blocks(blocks, [&](std::int64_t b) {
    std::int64_t count = 0;
    for (std::int64_t i = b * kCpuBlock; i < std::min(n, (b + 1) * kCpuBlock); ++i) count += keep(i) ? 1 : 0;
    first[static_cast<std::size_t>(b) + 1] = count;
  });
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  Buffer<std::int32_t> kept(ex.pool(), first.back());
  ex.run_blocks(blocks, [&](std::int64_t b) {
    std::int32_t* out = kept.data() + first[static_cast<std::size_t>(b)];
    for (std::int64_t i = b * kCpuBlock; i < std::min(n, (b + 1) * kCpuBlock); ++i)
      if (keep(i)) *out++ = static_cast<std::int32_t>(i);
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
  const auto blocks = static_cast<std::int64_t>(offsets.size());
  ex.run_blocks(blocks, [&](std::int64_t b) {
    Histogram& count = offsets[static_cast<std::size_t>(b)];
    count.fill(0);
    for (std::int64_t i = b * kCpuSortBlock; i < std::min(n, (b + 1) * kCpuSortBlock); ++i) ++count[digit_of(keys[i])];
  });
  std::int64_t next = 0;
  for (std::size_t digit = 0; digit < kDigits; ++digit) {
    const std::int64_t begin = next;
    for (Histogram& count : offsets) next += std::exchange(count[digit], next);
    if (next - begin == n) return false;
  }
  ex.run_blocks(blocks, [&](std::int64_t b) {
    Histogram& offset = offsets[static_cast<std::size_t>(b)];
    for (std::int64_t i = b * kCpuSortBlock; i < std::min(n, (b + 1) * kCpuSortBlock); ++i) {
      move(i, offset[digit_of(keys[i])]++);
    }
  });
  return true;
}

}  // namespace detail

/// Sorts (key, value) pairs by the lowest `bits` bits of the keys, ascending and stable. Least significant digit
/// first, 8 bits a pass, passes in which all keys agree are skipped. O(n bits / 8); n pairs of scratch.
template <class Value>
void sort_pairs(Cpu& ex, const char* /*label*/, Buffer<std::uint64_t>& keys, Buffer<Value>& values, int bits) {
  const std::int64_t n = keys.size();
  Buffer<std::uint64_t> other_keys(ex.pool(), n);
  Buffer<Value> other_values(ex.pool(), n);
  std::vector<detail::Histogram> offsets(static_cast<std::size_t>(block_count(n, kCpuSortBlock)));
  for (int shift = 0; shift < bits; shift += detail::kDigitBits) {
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

/// Sorts keys alone; otherwise as sort_pairs.
inline void sort_keys(Cpu& ex, const char* /*label*/, Buffer<std::uint64_t>& keys, int bits) {
  Buffer<std::uint64_t> other(ex.pool(), keys.size());
  std::vector<detail::Histogram> offsets(static_cast<std::size_t>(block_count(keys.size(), kCpuSortBlock)));
  for (int shift = 0; shift < bits; shift += detail::kDigitBits) {
    const auto move = [&](std::int64_t from, std::int64_t to) { other.data()[to] = keys.data()[from]; };
    if (detail::sort_pass(ex, detail::Digit(shift, bits), keys.cview(), offsets, move)) keys.swap(other);
  }
}

template <class T>
void copy(Cpu& /*ex*/, ArrayView<const T> from, ArrayView<T> to) {
  if (from.size > 0) std::memcpy(to.data, from.data, static_cast<std::size_t>(from.size) * sizeof(T));
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
