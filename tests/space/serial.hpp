// A third space: plain loops on one thread, nothing shared with the CPU's or the GPU's primitives. It shows what a new
// backend has to bring (docs/architecture.md), and what the results of all others must be.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "core/array_view.hpp"
#include "exec/lanes.hpp"
#include "exec/memory.hpp"
#include "exec/reduce_order.hpp"
#include "exec/sweep.hpp"

namespace pointskin::exec {

class SerialPool final : public MemoryPool {
 public:
  void trim() noexcept override {}

 private:
  static constexpr std::align_val_t kAlignment{256};
  void* take(std::size_t bytes) override { return ::operator new(bytes, kAlignment); }
  void give_back(void* block, std::size_t /*bytes*/) noexcept override { ::operator delete(block, kAlignment); }
};

class Serial {
 public:
  static constexpr bool kManyThreads = false;
  static constexpr bool kOnHost = false;  // it could be true: this way all that copies is tried
  static constexpr bool kOwnKernels = false;

  [[nodiscard]] const std::shared_ptr<MemoryPool>& pool() const { return pool_; }
  void synchronize() {}
  void activate() {}
  [[nodiscard]] int host_threads() const { return 1; }
  [[nodiscard]] void* stream() const { return nullptr; }
  void read(const void* from, void* to, std::size_t bytes) const { std::memcpy(to, from, bytes); }

  using Mark = std::chrono::steady_clock::time_point;
  [[nodiscard]] Mark mark() const { return std::chrono::steady_clock::now(); }
  [[nodiscard]] double milliseconds_between(const Mark& from, const Mark& to) const {
    return std::chrono::duration<double, std::milli>(to - from).count();
  }

 private:
  std::shared_ptr<MemoryPool> pool_ = std::make_shared<SerialPool>();
};

template <class F>
void for_each(Serial& /*ex*/, const char* /*label*/, std::int64_t n, const F& f) {
  for (std::int64_t i = n - 1; i >= 0; --i) f(i);  // backwards: no functor may count on an order
}

inline int lanes_apart(const Serial& /*ex*/, std::int64_t /*n*/) { return 1; }

template <class F>
void for_each_apart(Serial& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, f);
}

template <class F>
void for_each_long(Serial& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, f);
}

template <class F>
void for_each_by_lanes(Serial& ex, const char* label, std::int64_t n, const F& f) {
  for_each(ex, label, n, SumOfLanes<F>{f});
}

template <class F>
void sweep(Serial& ex, const char* label, int rounds, std::int64_t n, const F& f) {
  for (int round = 0; round < rounds; ++round)
    for_each(ex, label, indices_of_round(f, round, static_cast<int>(n)), SweepRound<F>{f, round});
}

template <class T, class Combine>
void reduce_tail(Serial& /*ex*/, const char* /*label*/, ArrayView<const T> values, ArrayView<T> out,
                 const Combine& combine) {
  std::vector<T> sums(values.begin(), values.end());
  while (sums.size() > 1) {
    const auto n = static_cast<std::int64_t>(sums.size());
    const std::int64_t lanes = reduce_lanes(n);
    std::vector<T> fewer;
    for (std::int64_t lane = 0; lane < lanes; ++lane)
      fewer.push_back(combine_lane(LoadValue<T>{{sums.data(), n}}, combine, n, lanes, lane));
    sums = std::move(fewer);
  }
  out[0] = sums.front();
}

template <class Keep>
Buffer<std::int32_t> select(Serial& ex, const char* /*label*/, std::int64_t n, const Keep& keep) {
  std::vector<std::int32_t> found;
  for (std::int64_t i = 0; i < n; ++i)
    if (keep(i)) found.push_back(static_cast<std::int32_t>(i));
  Buffer<std::int32_t> kept(ex.pool(), static_cast<std::int64_t>(found.size()));
  std::copy(found.begin(), found.end(), kept.data());
  return kept;
}

template <class T>
void exclusive_scan(Serial& /*ex*/, const char* /*label*/, ArrayView<const T> in, ArrayView<T> out) {
  T sum{};
  for (std::int64_t i = 0; i < in.size; ++i) {
    const T value = in[i];
    out[i] = sum;
    sum += value;
  }
  if (out.size > in.size) out[in.size] = sum;
}

template <class Value>
void sort_pairs(Serial& /*ex*/, const char* /*label*/, Buffer<std::uint64_t>& keys, Buffer<Value>& values, int bits,
                int first_bit = 0) {
  struct Pair {
    std::uint64_t key;
    Value value;
  };
  std::vector<Pair> pairs;
  for (std::int64_t i = 0; i < keys.size(); ++i) pairs.push_back({keys.data()[i], values.data()[i]});
  const std::uint64_t mask = (bits < 64 ? std::uint64_t{1} << bits : 0) - 1;
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
    return (a.key & mask) >> first_bit < (b.key & mask) >> first_bit;
  });
  for (std::int64_t i = 0; i < keys.size(); ++i) {
    keys.data()[i] = pairs[static_cast<std::size_t>(i)].key;
    values.data()[i] = pairs[static_cast<std::size_t>(i)].value;
  }
}

inline void sort_keys(Serial& /*ex*/, const char* /*label*/, Buffer<std::uint64_t>& keys, int bits) {
  const std::uint64_t mask = (bits < 64 ? std::uint64_t{1} << bits : 0) - 1;
  std::stable_sort(keys.data(), keys.data() + keys.size(),
                   [&](std::uint64_t a, std::uint64_t b) { return (a & mask) < (b & mask); });
}

template <class T>
void copy_to_host(Serial& /*ex*/, ArrayView<const T> from, T* to) {
  std::copy(from.begin(), from.end(), to);
}
template <class T>
void copy_to_device(Serial& /*ex*/, const T* from, ArrayView<T> to) {
  std::copy_n(from, to.size, to.data);
}
template <class T>
void copy_constant_to_device(Serial& ex, const T* from, ArrayView<T> to) {
  copy_to_device(ex, from, to);
}
template <class T>
void copy(Serial& /*ex*/, ArrayView<const T> from, ArrayView<T> to) {
  std::copy(from.begin(), from.end(), to.data);
}

using ThisSpace = Serial;

}  // namespace pointskin::exec
