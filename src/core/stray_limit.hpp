// How many points may be strays: the one rule of the readers and of the working cube.
#pragma once

#include <algorithm>
#include <cstdint>

namespace pointskin {

/// This many points may be strays even if they keep together: too few for a surface.
inline constexpr std::int64_t kFewPoints = 32;

/// Most strays that a cloud of n points may have: 32, in large clouds 1 point in 1000 up to 256, in small ones 1 in
/// 100; none below 128 points.
constexpr std::int64_t stray_limit(std::int64_t n) {
  constexpr std::int64_t kSmallestCloud = 128;
  constexpr std::int64_t kMany = 256;
  return n < kSmallestCloud ? 0 : std::min(n / 100, std::clamp(n / 1000, kFewPoints, kMany));
}

}  // namespace pointskin
