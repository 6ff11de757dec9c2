// Union-find that many threads of any space may use at once.
// Source: Jayanti & Tarjan, "Concurrent disjoint set union", Distributed Computing 34, 2021 (linking by index,
// path halving with compare-and-swap).
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/atomic.hpp"

namespace pointskin::exec {

/// A partition of [0, n) over an array that starts as 0, 1, ..., n-1 (exec::iota). Larger roots hang below smaller
/// ones, so each set's root ends as its smallest member and the result does not depend on the order of the calls.
struct DisjointSets {
  ArrayView<std::int32_t> parents;

  /// Joins the sets of `a` and `b`. Safe from many threads.
  PSK_HD void unite(std::int32_t a, std::int32_t b) const {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) {
        const std::int32_t smaller = a;
        a = b;
        b = smaller;
      }
      if (compare_exchange(parents.data + a, a, b) == a) return;
    }
  }

  /// The smallest member of the set of `i`, once all unite() calls are done. Safe from many threads.
  [[nodiscard]] PSK_HD std::int32_t root(std::int32_t i) const {
    for (;;) {
      const std::int32_t above = load(parents.data + i);
      if (above == i) return i;
      const std::int32_t next = load(parents.data + above);
      if (next != above) compare_exchange(parents.data + i, above, next);
      i = next;
    }
  }

  /// True for the smallest member of each set; only after all unite() calls are done.
  [[nodiscard]] PSK_HD bool is_root(std::int32_t i) const { return parents[i] == i; }
};

}  // namespace pointskin::exec
