// Data-parallel algorithms written once over the primitives of a space. Include after the primitives of the spaces
// used.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/reduce_order.hpp"
#include "exec/space.hpp"
#include "exec/sweep.hpp"

namespace pointskin::exec {

namespace detail {

template <class T>
struct Fill {
  ArrayView<T> out;
  T value;
  PSK_HD void operator()(std::int64_t i) const { out[i] = value; }
};

template <class T>
struct Gather {
  ArrayView<const T> in;
  ArrayView<const std::int32_t> index;
  ArrayView<T> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = in[index[i]]; }
};

struct Iota {
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<std::int32_t>(i); }
};

struct StartsRun {
  ArrayView<const std::uint64_t> keys;
  PSK_HD bool operator()(std::int64_t i) const { return i == 0 || keys[i] != keys[i - 1]; }
};

template <class T, class F, class Combine>
struct ReduceLane {
  F f;
  Combine combine;
  std::int64_t n, lanes;
  ArrayView<T> out;
  PSK_HD void operator()(std::int64_t lane) const { out[lane] = combine_lane(f, combine, n, lanes, lane); }
};

}  // namespace detail

/// For reduce(): a sum, which is the same in any order.
struct Plus {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

/// out[i] = value. n writes.
template <class T, Space Exec>
void fill(Exec& ex, ArrayView<T> out, T value) {
  for_each(ex, "fill", out.size, detail::Fill<T>{out, value});
}

/// out[i] = in[index[i]].
template <class T, Space Exec>
void gather(Exec& ex, ArrayView<const T> in, ArrayView<const std::int32_t> index, ArrayView<T> out) {
  for_each(ex, "gather", out.size, detail::Gather<T>{in, index, out});
}

/// One element of device memory, on the host. Waits for the work before it.
template <class T, Space Exec>
T read_element(Exec& ex, ArrayView<const T> from, std::int64_t i) {
  T value;
  copy_to_host(ex, from.part(i, 1), &value);
  return value;
}

/// All of a buffer, on the host. Waits for the work before it.
template <class T, Space Exec>
std::vector<T> to_vector(Exec& ex, const Buffer<T>& buffer) {
  std::vector<T> out(static_cast<std::size_t>(buffer.size()));
  copy_to_host(ex, buffer.cview(), out.data());
  return out;
}

/// Few bytes on the host, and work(), which launches what does not depend on them. A space where the host waits for its work
/// has a form of its own that calls work() first.
template <class T, Space Exec, class Work>
void copy_to_host_meanwhile(Exec& ex, ArrayView<const T> from, T* to, const Work& work) {
  copy_to_host(ex, from, to);
  work();
}

/// select, and work() as above.
template <Space Exec, class Keep, class Work>
Buffer<std::int32_t> select_meanwhile(Exec& ex, const char* label, std::int64_t n, const Keep& keep, const Work& work) {
  Buffer<std::int32_t> kept = select(ex, label, n, keep);
  work();
  return kept;
}

/// The rest of reduce: combines the lanes' values, of which there is at least one, to one element.
template <class T, Space Exec, class Combine>
Buffer<T> reduce_lane_values(Exec& ex, const char* label, Buffer<T> sums, Combine combine) {
  if constexpr (Exec::kOwnKernels && AnyOrder<Combine>)
    return reduce_any_order<T>(ex, label, sums.size(), LoadValue<T>{sums.cview()}, combine);
  std::int64_t lanes = sums.size();
  while (lanes > kReduceTail) {
    const std::int64_t fewer = reduce_lanes(lanes);
    Buffer<T> next = make_buffer<T>(ex, fewer);
    for_each_long(ex, label, fewer,
                  detail::ReduceLane<T, LoadValue<T>, Combine>{{sums.cview()}, combine, lanes, fewer, next.view()});
    sums = std::move(next);
    lanes = fewer;
  }
  if (lanes == 1) return sums;
  Buffer<T> total = make_buffer<T>(ex, 1);
  reduce_tail(ex, label, sums.cview(), total.view(), combine);
  return total;
}

/// combine over f(0), ..., f(n-1) for n > 0, in the order of exec/reduce_order.hpp, which depends on n alone: the same
/// bits in every space and for every number of threads. One element, in the space's memory: for work that follows.
/// A GPU takes combinations that are AnyOrder by blocks of threads. About n calls of f; O(log n) launches; does not wait.
template <class T, Space Exec, class F, class Combine>
Buffer<T> reduce_in_space(Exec& ex, const char* label, std::int64_t n, F f, Combine combine) {
  if constexpr (Exec::kOwnKernels && AnyOrder<Combine>) return reduce_any_order<T>(ex, label, n, f, combine);
  const std::int64_t lanes = reduce_lanes(n);
  Buffer<T> sums = make_buffer<T>(ex, lanes);
  for_each_long(ex, label, lanes, detail::ReduceLane<T, F, Combine>{f, combine, n, lanes, sums.view()});
  return reduce_lane_values(ex, label, std::move(sums), combine);
}

/// The same on the host. Waits.
template <class T, Space Exec, class F, class Combine>
T reduce(Exec& ex, const char* label, std::int64_t n, F f, Combine combine) {
  return read_element(ex, reduce_in_space<T>(ex, label, n, f, combine).cview(), 0);
}

/// Sum of counts, in 64 bits. Waits.
template <Space Exec>
std::int64_t sum_counts(Exec& ex, const char* label, ArrayView<const std::int32_t> counts) {
  if (counts.empty()) return 0;
  return reduce<std::int64_t>(ex, label, counts.size, LoadValue<std::int32_t>{counts}, Plus{});
}

/// 0, 1, ..., n-1.
template <Space Exec>
Buffer<std::int32_t> iota(Exec& ex, std::int64_t n) {
  Buffer<std::int32_t> out = make_buffer<std::int32_t>(ex, n);
  for_each(ex, "iota", n, detail::Iota{out.view()});
  return out;
}

/// Positions where a run of equal keys starts in sorted `keys`, ascending.
template <Space Exec>
Buffer<std::int32_t> run_starts(Exec& ex, const char* label, ArrayView<const std::uint64_t> keys) {
  return select(ex, label, keys.size, detail::StartsRun{keys});
}

/// Sorts `keys` by their lowest `bits` bits and removes repetitions.
template <Space Exec>
Buffer<std::uint64_t> sort_unique(Exec& ex, const char* label, Buffer<std::uint64_t> keys, int bits) {
  sort_keys(ex, label, keys, bits);
  const Buffer<std::int32_t> starts = run_starts(ex, label, keys.cview());
  Buffer<std::uint64_t> unique = make_buffer<std::uint64_t>(ex, starts.size());
  gather<std::uint64_t>(ex, keys.cview(), starts.cview(), unique.view());
  return unique;
}

}  // namespace pointskin::exec
