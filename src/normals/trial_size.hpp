// How large trial fields are.
#pragma once

#include <cstdint>

namespace pointskin::detail {

/// Working cube / bounding cube: the trial field is 0 on the cube, which must not be near.
inline constexpr double kTrialRoom = 1.5;

/// About 1.5 samples a cell of an even surface: the depth log4(n / 1.5), rounded. With twice as many, the smoothed
/// normals of sheets two spacings apart overlap, and speak for equal sides.
inline int trial_depth(std::int64_t n) {
  constexpr int kLeast = 4;
  constexpr int kMost = 13;
  int depth = kLeast;
  while (depth < kMost && (std::int64_t{3} << 2 * depth) < n) ++depth;
  return depth;
}

}  // namespace pointskin::detail
