#pragma once

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "poisson/previous.hpp"

namespace pointskin::poisson {
namespace previous {

/// Finds a brick of one tree in another: up to the root, and down the same way.
struct MatchBrick {
  octree::OctreeView tree, old_tree;
  ArrayView<std::int32_t> bricks;
  PSK_HD void operator()(std::int64_t brick_of_all) const {
    const int depth = tree.level_of(8 * brick_of_all);
    std::int32_t brick = static_cast<std::int32_t>(brick_of_all - tree.levels[depth].first_node / 8);
    std::int8_t way[octree::kMaxDepth + 1];
    for (int d = depth; d > 0; --d) {
      const std::int32_t parent = tree.levels[d].parent[brick];
      way[d] = static_cast<std::int8_t>(parent & 7);
      brick = parent >> 3;
    }
    std::int32_t old = 0;
    for (int d = 1; d <= depth && old >= 0; ++d) {
      old = old_tree.levels[d - 1].child_brick[8 * old + way[d]];
      if (old >= old_tree.levels[d].bricks) old = -1;
    }
    bricks[brick_of_all] = old;
  }
};

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

}  // namespace previous

template <exec::Space Exec>
exec::Buffer<std::int32_t> match_bricks(Exec& ex, const octree::OctreeView& tree, const octree::OctreeView& old_tree) {
  auto matches = exec::make_buffer<std::int32_t>(ex, tree.nodes / 8);
  for_each(ex, "solve.match", tree.nodes / 8, previous::MatchBrick{tree, old_tree, matches.view()});
  return matches;
}

}  // namespace pointskin::poisson
