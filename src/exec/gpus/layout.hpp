// Which part of an array, and of the work on it, is which GPU's. Nothing here needs a GPU.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "exec/gpus/shares.hpp"

namespace pointskin::exec::gpus {

/// An array whose parts are each in the order of space, such as the levels of an octree, or the cells of a level and its ghosts: each GPU
/// has a share of every part, so that what lies side by side in space lies on one GPU whatever the part. Arrays and launches of any
/// size are cut in the same proportions.
class Layout {
 public:
  struct Interval {
    std::int64_t begin, end;
    [[nodiscard]] std::int64_t size() const { return end - begin; }
    bool operator==(const Interval&) const = default;
  };

  /// One part.
  Layout() = default;
  /// Parts that end at borders[i] of `total`; the last ends there. Borders ascend; parts may be empty.
  Layout(const std::vector<std::int64_t>& borders, std::int64_t total) {
    ends_.clear();
    for (const std::int64_t border : borders)
      if (border > 0 && border < total) ends_.push_back(static_cast<double>(border) / static_cast<double>(total));
    ends_.push_back(1);
    ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  }

  /// What GPU `g` of `count` has of [0, n): of all parts, joined where they touch.
  [[nodiscard]] std::vector<Interval> of_gpu(int g, int count, std::int64_t n) const {
    std::vector<Interval> found;
    std::int64_t begin = 0;
    for (const double fraction : ends_) {
      const std::int64_t end = fraction < 1 ? static_cast<std::int64_t>(fraction * static_cast<double>(n)) : n;
      const Shares shares{end - begin, count};
      const Interval own{begin + shares.begin(g), begin + shares.end(g)};
      begin = end;
      if (own.size() == 0) continue;
      if (!found.empty() && found.back().end == own.begin)
        found.back().end = own.end;
      else
        found.push_back(own);
    }
    return found;
  }

  bool operator==(const Layout&) const = default;
  /// Any order, the same everywhere.
  bool operator<(const Layout& other) const { return ends_ < other.ends_; }

 private:
  std::vector<double> ends_ = {1};
};

/// An interval and whose it is.
struct Owned {
  int gpu;
  Layout::Interval interval;
  bool operator==(const Owned&) const = default;
};

/// Whose the elements, or pages, [0, n) are, in their order.
inline std::vector<Owned> owners_of(const Layout& layout, int count, std::int64_t n) {
  std::vector<Owned> owned;
  for (int g = 0; g < count; ++g)
    for (const Layout::Interval& own : layout.of_gpu(g, count, n)) owned.push_back({g, own});
  std::sort(owned.begin(), owned.end(),
            [](const Owned& a, const Owned& b) { return a.interval.begin < b.interval.begin; });
  return owned;
}

}  // namespace pointskin::exec::gpus
