// How arrays over an octree and the work on them are cut for several GPUs: levels follow each other, and of a level its cells, the
// ghosts below cells of the level above, and those below its ghosts, each in the order of space.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/placed.hpp"
#include "octree/tables.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// For what has one entry, or several, a brick of the level, a LevelView or LevelData.
template <exec::Space Exec, class Level>
exec::Placed<Exec> placed_on_level(Exec& ex, const Level& level) {
  return {ex, {level.cell_bricks, level.cell_bricks + level.near_ghosts}, level.bricks};
}

/// For what has one entry, or several, a brick of all levels 0..last. Levels that are complete are small.
template <exec::Space Exec>
exec::Placed<Exec> placed_on_levels(Exec& ex, const OctreeView& tree, int last) {
  std::vector<std::int64_t> borders;
  for (int d = kCompleteDepth + 1; d <= last; ++d) {
    const LevelView& level = tree.levels[d];
    borders.push_back(level.first_node);
    borders.push_back(level.first_node + std::int64_t{8} * level.cell_bricks);
    borders.push_back(level.first_node + std::int64_t{8} * (level.cell_bricks + level.near_ghosts));
  }
  return {ex, borders, tree.levels[last].first_node + tree.levels[last].nodes()};
}

}  // namespace pointskin::octree
