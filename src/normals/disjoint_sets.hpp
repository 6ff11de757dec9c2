// Sets that grow together, with the smallest member of each as its name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "exec/disjoint_sets.hpp"

namespace pointskin::normals {

/// exec::DisjointSets with an array of their own on the host, for one thread.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::int32_t{0});
  }

  /// The smallest member of the set of `a`.
  [[nodiscard]] std::size_t root(std::size_t a) const {
    return static_cast<std::size_t>(sets().root(static_cast<std::int32_t>(a)));
  }
  void unite(std::size_t a, std::size_t b) { sets().unite(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)); }

  /// The sets, numbered by their smallest members.
  struct Numbers {
    std::size_t count = 0;
    std::vector<std::int32_t> of;  ///< number of the set of every member
  };
  [[nodiscard]] Numbers numbers() const {
    Numbers out{0, std::vector<std::int32_t>(parents_.size())};
    for (std::size_t a = 0; a < parents_.size(); ++a) {
      const std::size_t r = root(a);
      out.of[a] = r == a ? static_cast<std::int32_t>(out.count++) : out.of[r];
    }
    return out;
  }

 private:
  [[nodiscard]] exec::DisjointSets sets() const {
    return {{parents_.data(), static_cast<std::int64_t>(parents_.size())}};
  }
  mutable std::vector<std::int32_t> parents_;  // who looks for a root shortens the way to it
};

}  // namespace pointskin::normals
