// Sets that grow together, with the smallest member of each as its name.
// Source: Galler & Fischer, "An improved equivalence algorithm", Communications of the ACM 7, 1964.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pointskin::detail {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  /// The smallest member of the set of `a`.
  [[nodiscard]] std::size_t root(std::size_t a) const {
    while (parents_[a] != a) a = parents_[a];
    return a;
  }
  void unite(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

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
  std::vector<std::size_t> parents_;
};

}  // namespace pointskin::detail
