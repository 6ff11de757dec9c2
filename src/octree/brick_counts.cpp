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

/// The cell bricks of a level, to look up.
struct BrickSet {
  ArrayView<const std::uint64_t> keys;  // sorted
  std::int32_t bricks_per_axis;
  const std::uint32_t* words;  // bitmap of the keys, or null

  [[nodiscard]] bool holds(const Coordinates& c) const {
    const bool in_cube =
        c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < bricks_per_axis && c.y < bricks_per_axis && c.z < bricks_per_axis;
    if (!in_cube) return false;
    const std::uint64_t key = encode(c);
    if (words == nullptr) return std::binary_search(keys.begin(), keys.end(), key);
    return (words[key / build::kWordBits] >> key % build::kWordBits & 1) != 0;
  }
};

struct MarkBrick {
  ArrayView<const std::uint64_t> keys;
  build::BrickBits bits;
  void operator()(std::int64_t b) const { bits.insert(keys[b]); }
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

/// Ghosts of level d > kCompleteDepth. A bitmap of up to 4 bytes a node finds neighbours several times faster.
std::int64_t count_ghosts(exec::Cpu& ex, ArrayView<const std::uint64_t> keys, int d) {
  constexpr std::int64_t kMostWordsPerBrick = 8;
  if (keys.empty()) return 0;
  BrickSet set{keys, 1 << (d - 1), nullptr};
  exec::Buffer<std::uint32_t> words;
  if (build::bitmap_words(d) <= kMostWordsPerBrick * keys.size) {
    words = exec::make_buffer<std::uint32_t>(ex, build::bitmap_words(d));
    exec::fill(ex, words.view(), 0U);
    for_each(ex, "count.mark", keys.size, MarkBrick{keys, {words.data()}});
    set.words = words.data();
  }
  return exec::reduce<std::int64_t>(ex, "count.ghosts", keys.size, CountGhosts{set}, Plus{});
}

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
    level.bricks = cells.size + count_ghosts(ex, cells, d);
  }
  return counts;
}

}  // namespace pointskin::octree
