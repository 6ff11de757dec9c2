// The order in which reduce() combines values: the same in every space, so floating-point sums have the same bits.
//
// Of n values, lane l of max(1, n / 64) combines values l, l + lanes, l + 2 lanes, ... one after another (neighbouring
// lanes touch neighbouring memory); then the same over the lanes, until one is left.
#pragma once

#include <concepts>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"

namespace pointskin::exec {

inline constexpr std::int64_t kReduceLane = 64;

/// Up to this many values are combined by one block of threads.
inline constexpr std::int64_t kReduceTail = 512;

PSK_HD constexpr std::int64_t reduce_lanes(std::int64_t n) { return n < 2 * kReduceLane ? 1 : n / kReduceLane; }

/// True for combinations that give the same bits in any order, and say so: integers' sums, smallest and largest.
template <class Combine>
concept AnyOrder = requires {
  requires Combine::kAnyOrder;
};

/// What one lane combines. Values are fetched in batches, so that their latencies overlap.
template <class F, class Combine>
PSK_HD auto combine_lane(const F& f, const Combine& combine, std::int64_t n, std::int64_t lanes, std::int64_t lane) {
  constexpr int kBatch = 16;
  auto sum = f(lane);
  std::int64_t i = lane + lanes;
  for (; i + (kBatch - 1) * lanes < n; i += kBatch * lanes) {
    decltype(sum) batch[kBatch];
    PSK_UNROLL
    for (int k = 0; k < kBatch; ++k) batch[k] = f(i + k * lanes);
    PSK_UNROLL
    for (int k = 0; k < kBatch; ++k) sum = combine(sum, batch[k]);
  }
  for (; i < n; i += lanes) sum = combine(sum, f(i));
  return sum;
}

template <class T>
struct LoadValue {
  ArrayView<const T> in;
  PSK_HD T operator()(std::int64_t i) const { return in[i]; }
};

}  // namespace pointskin::exec
