// How arrays over an octree and the work on them are cut for several GPUs: levels follow each other, and of a level its cells, the
// ghosts below cells of the level above, and those below its ghosts, each in the order of space.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/placed.hpp"
#include "octree/tables.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// Where the parts of a level end, in bricks times `scale`, if it begins at `begin`.
template <class Level>
void append_borders(std::vector<std::int64_t>& borders, std::int64_t begin, const Level& level,
                    std::int64_t scale = 1) {
  borders.push_back(begin);
  borders.push_back(begin + scale * level.cell_bricks);
  borders.push_back(begin + scale * (level.cell_bricks + level.near_ghosts));
}

/// For what has one entry, or several, a brick of the level, a LevelView or LevelData.
template <exec::Space Exec, class Level>
exec::Placed<Exec> placed_on_level(Exec& ex, const Level& level) {
  std::vector<std::int64_t> borders;
  append_borders(borders, 0, level);
  return {ex, borders, level.bricks};
}

/// For what has one entry, or several, a brick of all levels 0..last. Levels that are complete are small.
template <exec::Space Exec>
exec::Placed<Exec> placed_on_levels(Exec& ex, const OctreeView& tree, int last) {
  std::vector<std::int64_t> borders;
  for (int d = kCompleteDepth + 1; d <= last; ++d)
    append_borders(borders, tree.levels[d].first_node, tree.levels[d], 8);
  return {ex, borders, tree.levels[last].first_node + tree.levels[last].nodes()};
}

}  // namespace pointskin::octree
