// What a solve starts from, where a field before is known.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "octree/access.hpp"
#include "octree/view.hpp"

namespace pointskin::poisson {

/// What the field before had added to the interpolation of the level above, at the places of a new level.
struct Detail {
  octree::LevelView level, old_level, old_above;
  const float *old_u, *old_above_u;  // of the two levels
  const std::int32_t* bricks;        // of the level
  PSK_HD float operator()(std::int64_t n) const {
    const std::int64_t brick = n >> 3;
    const int slot = static_cast<int>(n & 7);
    const std::int32_t old = bricks[brick];
    if (old < 0 || (level.unknowns[brick] >> slot & 1) == 0) return 0;
    if ((old_level.unknowns[old] >> slot & 1) == 0) return 0;  // it added nothing
    return old_u[8 * old + slot] - octree::prolonged(old_above, old_above_u, old_level.parent[old], slot);
  }
};

}  // namespace pointskin::poisson
