#pragma once

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "poisson/previous.hpp"

namespace pointskin::poisson {
namespace previous {

/// Matches the bricks of one level, after those of the level above.
struct MatchBricks {
  octree::LevelView level, old_above;
  std::int64_t old_bricks;    ///< of the level
  const std::int32_t* above;  ///< (bricks of the level above)
  ArrayView<std::int32_t> bricks;
  PSK_HD void operator()(std::int64_t b) const {
    const std::int32_t parent = level.parent[b];
    const std::int32_t old = above[parent >> 3];
    const std::int32_t brick = old < 0 ? -1 : old_above.child_brick[8 * old + (parent & 7)];
    bricks[b] = brick < old_bricks ? brick : -1;
  }
};

/// Adds to the interpolated values of a level what the field before had added to its own.
struct AddDetail {
  octree::LevelView level, old_level, old_above;
  const float *old_u, *old_above_u;  // of the two levels
  const std::int32_t* bricks;        // of the level
  ArrayView<float> u, other;
  PSK_HD void operator()(std::int64_t n) const {
    const std::int64_t brick = n >> 3;
    const int slot = static_cast<int>(n & 7);
    const std::int32_t old = bricks[brick];
    if (old < 0 || (level.unknowns[brick] >> slot & 1) == 0) return;
    if ((old_level.unknowns[old] >> slot & 1) == 0) return;  // it added nothing
    const float value =
        u[n] + (old_u[8 * old + slot] - octree::prolonged(old_above, old_above_u, old_level.parent[old], slot));
    u[n] = value;
    other[n] = value;
  }
};

}  // namespace previous

template <exec::Space Exec>
exec::Buffer<std::int32_t> match_bricks(Exec& ex, const octree::OctreeView& tree, const octree::OctreeView& old_tree) {
  auto matches = exec::make_buffer<std::int32_t>(ex, tree.nodes / 8);
  const auto of_level = [&](int d) {
    return matches.view().part(tree.levels[d].first_node / 8, tree.levels[d].bricks);
  };
  exec::fill(ex, of_level(0), 0);
  for (int d = 1; d <= tree.depth; ++d)
    for_each(ex, "solve.match", tree.levels[d].bricks,
             previous::MatchBricks{tree.levels[d], old_tree.levels[d - 1], old_tree.levels[d].bricks,
                                   of_level(d - 1).data, of_level(d)});
  return matches;
}

}  // namespace pointskin::poisson
