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

/// Ghost bricks one step above a cell brick that no cell brick before it counts. A brick that is one step above some
/// cell brick is a cell brick or a ghost: the node that it divides exists, since split cells have all their neighbours
/// and the complete levels all their ghosts.
struct CountGhosts {
  ArrayView<const std::uint64_t> cell_bricks;  // sorted keys

  std::int64_t operator()(std::int64_t b) const {
    const Coordinates c = decode(cell_bricks[b]);
    std::int64_t ghosts = 0;
    for (int s = 1; s < 8; ++s) {
      const Coordinates above{c.x + slot_x(s), c.y + slot_y(s), c.z + slot_z(s)};
      if (!is_cell_brick(above, b) && first_below(above, b) == s) ++ghosts;
    }
    return ghosts;
  }

  /// The first step that leads down from a ghost to a cell brick.
  [[nodiscard]] int first_below(const Coordinates& ghost, std::int64_t near) const {
    int s = 1;
    while (s < 8 && !is_cell_brick({ghost.x - slot_x(s), ghost.y - slot_y(s), ghost.z - slot_z(s)}, near)) ++s;
    return s;
  }

  /// Looks around `near` first, in steps that double: most neighbours are close in Morton order.
  [[nodiscard]] bool is_cell_brick(const Coordinates& c, std::int64_t near) const {
    if (c.x < 0 || c.y < 0 || c.z < 0) return false;
    const std::uint64_t key = encode(c);
    std::int64_t low = near;   // keys before it are smaller
    std::int64_t high = near;  // keys from it on are not
    for (std::int64_t step = 1; low > 0 && cell_bricks[low] > key; step *= 2) {
      high = low;
      low = std::max<std::int64_t>(0, low - step);
    }
    for (std::int64_t step = 1; high < cell_bricks.size && cell_bricks[high] < key; step *= 2) {
      low = high;
      high = std::min(cell_bricks.size, high + step);
    }
    const std::uint64_t* found = std::lower_bound(cell_bricks.data + low, cell_bricks.data + high, key);
    return found != cell_bricks.end() && *found == key;
  }
};

}  // namespace

std::vector<BrickCounts> count_bricks(exec::Cpu& ex, ArrayView<const std::uint64_t> point_keys, int depth) {
  build::BrickKeys keys = find_brick_keys(ex, point_keys, depth);
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
    const ArrayView<const std::uint64_t> cells = keys[static_cast<std::size_t>(d)].cview();
    level.cell_bricks = cells.size;
    level.bricks = cells.size;
    if (!cells.empty())
      level.bricks += exec::reduce<std::int64_t>(ex, "count.ghosts", cells.size, CountGhosts{cells}, Plus{});
  }
  return counts;
}

}  // namespace pointskin::octree
