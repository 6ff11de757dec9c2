#include "octree/brick_counts.hpp"

#include <algorithm>

#include "exec/cpu_primitives.hpp"
#include "octree/brick_sets.hpp"
#include "octree/complete_levels.hpp"

namespace pointskin::octree {
namespace {

struct Plus {
  std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

/// 1 for the first point of every occupied cell.
struct CountCell {
  build::StartsCell starts_cell;
  std::int64_t operator()(std::int64_t i) const { return starts_cell(i) ? 1 : 0; }
};

/// The cell bricks of a level too fine for a bitmap, to look up.
struct BrickSet {
  ArrayView<const std::uint64_t> keys;  // sorted
  std::int32_t bricks_per_axis;

  [[nodiscard]] bool holds(const Coordinates& c) const {
    const bool in_cube =
        c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < bricks_per_axis && c.y < bricks_per_axis && c.z < bricks_per_axis;
    return in_cube && std::binary_search(keys.begin(), keys.end(), encode(c));
  }
};

/// Ghost bricks one step above a cell brick that no other one counts. A place one step above some cell brick is a cell
/// brick or a ghost: the node that it divides exists, since split cells have all their neighbours and the complete
/// levels all their ghosts.
struct CountGhosts {
  BrickSet cell_bricks;

  std::int64_t operator()(std::int64_t b) const {
    const Coordinates c = decode(cell_bricks.keys[b]);
    std::int64_t ghosts = 0;
    for (int s = 1; s < 8; ++s) {
      const Coordinates above{c.x + slot_x(s), c.y + slot_y(s), c.z + slot_z(s)};
      if (!cell_bricks.holds(above) && first_below(above) == s) ++ghosts;
    }
    return ghosts;
  }

  /// The first step that leads down from a ghost to a cell brick.
  [[nodiscard]] int first_below(const Coordinates& ghost) const {
    int s = 1;
    while (s < 8 && !cell_bricks.holds({ghost.x - slot_x(s), ghost.y - slot_y(s), ghost.z - slot_z(s)})) ++s;
    return s;
  }
};

/// Ghosts of level d > kCompleteDepth.
std::int64_t count_ghosts(exec::Cpu& ex, ArrayView<const std::uint64_t> keys, int d) {
  if (keys.empty()) return 0;
  return exec::reduce<std::int64_t>(ex, "count.ghosts", keys.size, CountGhosts{{keys, 1 << (d - 1)}}, Plus{});
}

}  // namespace

std::vector<BrickCounts> count_bricks(exec::Cpu& ex, ArrayView<const std::uint64_t> point_keys, int depth) {
  const build::BrickSets sets = find_brick_sets(ex, point_keys, depth, [] {});
  std::vector<BrickCounts> counts(static_cast<std::size_t>(depth) + 1);
  for (int d = 0; d <= depth; ++d) {
    BrickCounts& level = counts[static_cast<std::size_t>(d)];
    if (!point_keys.empty())
      level.occupied_cells =
          exec::reduce<std::int64_t>(ex, "count.cells", point_keys.size, CountCell{{point_keys, d}}, Plus{});
    if (d <= kCompleteDepth) {
      level.cell_bricks = complete::cell_bricks(d);
      level.bricks = complete::bricks(d);
      continue;
    }
    const ArrayView<const std::uint64_t> cells = sets.keys[static_cast<std::size_t>(d)].cview();
    level.cell_bricks = cells.size;
    level.bricks = cells.size + (sets.has_ghosts(d) ? sets.ghosts_of(d).size : count_ghosts(ex, cells, d));
  }
  return counts;
}

}  // namespace pointskin::octree
