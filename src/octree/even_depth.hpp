// The depth whose cells a surface with evenly spread samples fills.
#pragma once

#include <cstdint>

namespace pointskin::octree {

/// About 1.5 samples a cell: the depth log4(n / 1.5), rounded, in [4, 13].
inline int depth_of_even_samples(std::int64_t n) {
  constexpr int kLeast = 4;
  constexpr int kMost = 13;
  int depth = kLeast;
  while (depth < kMost && (std::int64_t{3} << 2 * depth) < n) ++depth;
  return depth;
}

}  // namespace pointskin::octree
