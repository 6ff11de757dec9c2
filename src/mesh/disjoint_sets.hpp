// Union-find that many threads may use at once.
// Source: Jayanti & Tarjan, "Concurrent disjoint set union", Distributed Computing 34, 2021 (linking by index,
// path halving with compare-and-swap).
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {

/// A partition of [0, n). Larger roots hang below smaller ones, so each set's root ends as its smallest member and the
/// result does not depend on the order of the calls.
class DisjointSets {
 public:
  DisjointSets(exec::Cpu& ex, std::int64_t n) : parents_(ex.pool(), n) {
    exec::for_each(ex, "components", n, [this](std::int64_t i) { parents_.data()[i] = static_cast<std::int32_t>(i); });
  }

  /// Joins the sets of `a` and `b`. Safe from many threads.
  void unite(std::int32_t a, std::int32_t b) const {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::int32_t expected = a;
      if (parent(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

  /// True for the smallest member of each set; only after all unite() calls are done.
  [[nodiscard]] bool is_root(std::int32_t i) const { return parents_.data()[i] == i; }

 private:
  [[nodiscard]] std::atomic_ref<std::int32_t> parent(std::int32_t i) const {
    return std::atomic_ref<std::int32_t>(parents_.data()[i]);
  }

  [[nodiscard]] std::int32_t root(std::int32_t i) const {
    for (;;) {
      std::int32_t above = parent(i).load(std::memory_order_relaxed);
      if (above == i) return i;
      const std::int32_t next = parent(above).load(std::memory_order_relaxed);
      if (next != above) parent(i).compare_exchange_weak(above, next, std::memory_order_relaxed);
      i = next;
    }
  }

  exec::Buffer<std::int32_t> parents_;
};

}  // namespace pointskin::mesh_detail
