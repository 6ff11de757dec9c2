// Octree construction, level by level, in parallel over nodes.
// Source: Zhou et al. 2010, section 3 (Listings 1 and 2).
// Differs: bricks of siblings instead of nodes; padding and grading come from the 27-neighbourhoods of cells; corners,
// edges and faces are owned by position, so they need neither arrays nor sorting (docs/paper.md, P1-P3).
#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "exec/algorithms.hpp"
#include "exec/space.hpp"
#include "octree/brick_sets.hpp"
#include "octree/complete_levels.hpp"
#include "octree/octree_data.hpp"
#include "octree/tables.hpp"

namespace pointskin::octree {
namespace build {

struct PointKey {
  ArrayView<const Vec3f> positions;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    keys[i] = point_key(p.x, p.y, p.z);
  }
};

/// 1 where a point has the key of the one before it.
struct RepeatsKey {
  ArrayView<const std::uint64_t> keys;
  PSK_HD std::int32_t operator()(std::int64_t i) const { return i > 0 && keys[i] == keys[i - 1] ? 1 : 0; }
};

struct Larger {
  PSK_HD std::int32_t operator()(std::int32_t a, std::int32_t b) const { return a > b ? a : b; }
};

/// Node with this key among the nodes of bricks with sorted keys; it must exist. O(log bricks).
PSK_HD inline std::int64_t find_node(ArrayView<const std::uint64_t> brick_keys, std::uint64_t node_key) {
  std::int64_t low = 0;
  std::int64_t high = brick_keys.size - 1;
  while (low < high) {
    const std::int64_t middle = (low + high) / 2;
    if (brick_keys[middle] < node_key >> 3)
      low = middle + 1;
    else
      high = middle;
  }
  return 8 * low + static_cast<std::int64_t>(node_key & 7);
}

/// Parent node of a cell brick: the node of the level above whose key is the brick's.
struct FindParent {
  ArrayView<const std::uint64_t> keys;        // of this level's cell bricks
  ArrayView<const std::uint64_t> above_keys;  // of the cell bricks above
  ArrayView<std::int32_t> parent;
  ArrayView<std::int32_t> child_brick_above;

  PSK_HD void operator()(std::int64_t b) const {
    const auto node = static_cast<std::int32_t>(find_node(above_keys, keys[b]));
    parent[b] = node;
    child_brick_above[node] = static_cast<std::int32_t>(b);
  }
};

/// Nodes of the level above that need a ghost brick: not split, but some node one step below them is.
struct NeedsGhost {
  LevelView above;  // its child_brick holds cell bricks only
  PSK_HD bool operator()(std::int64_t i) const {
    const auto node = static_cast<std::int32_t>(i);
    if (above.child_brick[node] >= 0) return false;
    for (int s = 1; s < 8; ++s) {
      const std::int32_t lower = above.neighbour(node, -slot_x(s), -slot_y(s), -slot_z(s));
      if (lower >= 0 && above.child_brick[lower] >= 0) return true;
    }
    return false;
  }
};

struct AddGhost {
  LevelView above;
  ArrayView<const std::int32_t> ghosts;  // their parent nodes; or, if `by_step`, 8 brick + step
  bool by_step;
  std::int32_t first;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> parent;  // of the cell bricks already
  ArrayView<std::int32_t> child_brick_above;

  [[nodiscard]] PSK_HD std::int32_t parent_of(std::int32_t ghost) const {
    const int step = ghost & 7;
    return by_step ? above.neighbour(parent[ghost >> 3], slot_x(step), slot_y(step), slot_z(step)) : ghost;
  }
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t node = parent_of(ghosts[i]);
    keys[first + i] = above.node_key(node);
    parent[first + i] = node;
    child_brick_above[node] = static_cast<std::int32_t>(first + i);
  }
};

/// Listing 2 of the paper, on bricks.
struct FindNeighbours {
  LevelView above;  // complete
  ArrayView<const std::int32_t> parent;
  ArrayView<std::int32_t> neighbours;
};
/// One brick, for spaces with few threads: by the paper's tables.
struct FindNeighboursOfBrick : FindNeighbours {
  NeighbourTables tables;

  PSK_HD void operator()(std::int64_t b) const {
    const std::int32_t node = parent[b];
    const std::int64_t around = std::int64_t{node >> 3} * kNeighbours;
    const int slot = node & 7;
    for (int j = 0; j < kNeighbours; ++j) {
      const std::int32_t brick = above.neighbours[around + tables.parent[slot][j]];
      neighbours[b * kNeighbours + j] = brick < 0 ? -1 : above.child_brick[brick * 8 + tables.child[slot][j]];
    }
  }
};
/// One entry, for spaces with many: threads that look up different entries of a table in constant memory wait for each
/// other, so the entries are computed.
struct FindNeighbour : FindNeighbours {
  PSK_HD void operator()(std::int64_t i) const {
    const auto b = static_cast<std::int32_t>(i / kNeighbours);
    const auto j = static_cast<int>(i - std::int64_t{b} * kNeighbours);
    const std::int32_t node = above.neighbour(parent[b], j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1);
    neighbours[i] = node < 0 ? -1 : above.child_brick[node];
  }
};

/// A corner is an unknown if all cells around it that lie in the cube are cells of this level.
struct FindUnknowns {
  LevelView level;
  ArrayView<std::uint8_t> unknowns;

  PSK_HD void operator()(std::int64_t b) const {
    const Coordinates c = decode(level.brick_key[b]);
    const std::int32_t bricks_per_axis = 1 << (level.depth - 1);
    unsigned missing = 0;  // bricks in the cube whose nodes are no cells of this level, by neighbour index
    PSK_UNROLL for (int j = 0; j < kNeighbours; ++j) {
      const std::int32_t brick = level.neighbours[b * kNeighbours + j];
      const std::int32_t x = c.x + j / 9 - 1;
      const std::int32_t y = c.y + j / 3 % 3 - 1;
      const std::int32_t z = c.z + j % 3 - 1;
      const bool in_cube =
          x >= 0 && y >= 0 && z >= 0 && x < bricks_per_axis && y < bricks_per_axis && z < bricks_per_axis;
      if (in_cube && (brick < 0 || brick >= level.cell_bricks)) missing |= 1U << j;
    }
    const std::int32_t last = 1 << level.depth;
    int mask = 0;
    for (int s = 0; s < 8; ++s) {
      const bool in_grid = 2 * c.x + slot_x(s) <= last && 2 * c.y + slot_y(s) <= last && 2 * c.z + slot_z(s) <= last;
      if (in_grid && (missing & bricks_of_cells_around(s)) == 0) mask |= 1 << s;
    }
    unknowns[b] = static_cast<std::uint8_t>(mask);
  }

  /// Bricks that the 8 cells around corner `slot` of a brick belong to: itself and, on lower sides, those before it.
  PSK_HD static unsigned bricks_of_cells_around(int slot) {
    unsigned bricks = 0;
    for (int s = 0; s < 8; ++s)
      if ((s & slot) == 0) bricks |= 1U << neighbour_index(-slot_x(s), -slot_y(s), -slot_z(s));
    return bricks;
  }
};

/// First of the sorted points [first, last) beyond a cell. O(log(last - first)).
PSK_HD inline std::int32_t end_of_cell(ArrayView<const std::uint64_t> point_keys, std::uint64_t cell, int depth,
                                       std::int32_t first, std::int32_t last) {
  while (first < last) {
    const std::int32_t middle = first + (last - first) / 2;
    if (cell_key(point_keys[middle], depth) <= cell)
      first = middle + 1;
    else
      last = middle;
  }
  return first;
}

/// First points of the cells of all levels at once, for spaces with many threads.
struct FindAllPoints {
  OctreeView tree;
  std::int32_t* point_begin[kMaxDepth + 1];
  ArrayView<const std::uint64_t> point_keys;

  PSK_HD void operator()(std::int64_t i) const {
    int depth = tree.depth;  // most cells are there; entries are counted from the finest level
    std::int64_t cell = i;
    while (cell > 8 * std::int64_t{tree.levels[depth].cell_bricks})
      cell -= 8 * std::int64_t{tree.levels[depth--].cell_bricks} + 1;
    const LevelView& level = tree.levels[depth];
    const auto points = static_cast<std::int32_t>(point_keys.size);
    std::int32_t first = points;
    if (cell < level.cells()) {
      const std::uint64_t key = level.node_key(static_cast<std::int32_t>(cell));
      first = key == 0 ? 0 : end_of_cell(point_keys, key - 1, depth, 0, points);
    }
    point_begin[depth][cell] = first;
  }
};

/// First points of the cells of a brick, found in the range of the cell it divides, for spaces with few threads.
struct FindPoints {
  LevelView level;
  const std::int32_t* above_begin;
  ArrayView<const std::uint64_t> point_keys;
  ArrayView<std::int32_t> point_begin;

  PSK_HD void operator()(std::int64_t b) const {
    if (b == level.cell_bricks) {
      point_begin[8 * b] = static_cast<std::int32_t>(point_keys.size);
      return;
    }
    const std::int32_t node = level.parent[b];
    std::int32_t first = above_begin[node];
    const std::int32_t last = above_begin[node + 1];
    for (int s = 0; s < 8; ++s) {
      point_begin[8 * b + s] = first;
      if (s == 7) return;
      first = end_of_cell(point_keys, level.brick_key[b] << 3 | static_cast<unsigned>(s), level.depth, first, last);
    }
  }
};

/// The root cell holds all points.
struct RootPoints {
  std::int32_t points;
  ArrayView<std::int32_t> point_begin;
  PSK_HD void operator()(std::int64_t i) const { point_begin[i] = i == 0 ? 0 : points; }
};

/// Ghost bricks, ids, neighbours and unknowns of level `d`, whose cell brick keys are given. Levels above are complete.
template <exec::Space Exec>
void link_level(Exec& ex, OctreeData& tree, int d, const BrickSets& sets) {
  const exec::Buffer<std::uint64_t>& cell_keys = sets.keys[static_cast<std::size_t>(d)];
  LevelData& above = tree.levels[static_cast<std::size_t>(d - 1)];
  LevelData& level = tree.levels[static_cast<std::size_t>(d)];
  const auto cell_bricks = static_cast<std::int32_t>(cell_keys.size());

  above.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * above.bricks);
  exec::fill(ex, above.child_brick.view(), std::int32_t{-1});
  auto cell_parents = exec::make_buffer<std::int32_t>(ex, cell_bricks);
  const ArrayView<const std::uint64_t> above_keys = above.brick_key.cview().part(0, above.cell_bricks);
  for_each(ex, "octree.parent", cell_bricks,
           FindParent{cell_keys.cview(), above_keys, cell_parents.view(), above.child_brick.view()});

  const LevelView above_view = tree.view().levels[d - 1];
  const bool has_ghosts = sets.has_ghosts(d);
  exec::Buffer<std::int32_t> ghost_parents;
  if (!has_ghosts) ghost_parents = select(ex, "octree.ghosts", above_view.nodes(), NeedsGhost{above_view});
  const ArrayView<const std::int32_t> ghosts = has_ghosts ? sets.ghosts_of(d) : ghost_parents.cview();
  check_limit(cell_bricks + ghosts.size, d);
  level.cell_bricks = cell_bricks;
  level.bricks = static_cast<std::int32_t>(cell_bricks + ghosts.size);
  level.brick_key = exec::make_buffer<std::uint64_t>(ex, level.bricks);
  level.parent = exec::make_buffer<std::int32_t>(ex, level.bricks);
  copy(ex, cell_keys.cview(), level.brick_key.view().part(0, cell_bricks));
  copy(ex, cell_parents.cview(), level.parent.view().part(0, cell_bricks));
  for_each(ex, "octree.ghosts", ghosts.size,
           AddGhost{above_view, ghosts, has_ghosts, cell_bricks, level.brick_key.view(), level.parent.view(),
                    above.child_brick.view()});

  level.neighbours = exec::make_buffer<std::int32_t>(ex, std::int64_t{kNeighbours} * level.bricks);
  const FindNeighbours find{above_view, level.parent.cview(), level.neighbours.view()};
  if constexpr (Exec::kManyThreads)
    for_each(ex, "octree.neighbours", level.neighbours.size(), FindNeighbour{find});
  else
    for_each(ex, "octree.neighbours", level.bricks, FindNeighboursOfBrick{find, kNeighbourTables});
  level.unknowns = exec::make_buffer<std::uint8_t>(ex, level.bricks);
  for_each(ex, "octree.unknowns", level.bricks, FindUnknowns{tree.view().levels[d], level.unknowns.view()});
}

/// Point ranges of all cells.
template <exec::Space Exec>
void assign_points(Exec& ex, OctreeData& tree, ArrayView<const std::uint64_t> point_keys) {
  FindAllPoints find{tree.view(), {}, point_keys};
  std::int64_t entries = 0;
  for (int d = 0; d <= tree.depth; ++d) {
    LevelData& level = tree.levels[static_cast<std::size_t>(d)];
    level.point_begin = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * level.cell_bricks + 1);
    find.point_begin[d] = level.point_begin.data();
    entries += level.point_begin.size();
  }
  if constexpr (Exec::kManyThreads) {
    for_each(ex, "octree.points", entries, find);
  } else {
    const LevelData& root = tree.levels.front();
    for_each(ex, "octree.points", root.point_begin.size(),
             RootPoints{static_cast<std::int32_t>(point_keys.size), root.point_begin.view()});
    for (int d = 1; d <= tree.depth; ++d) {
      const LevelData& level = tree.levels[static_cast<std::size_t>(d)];
      for_each(ex, "octree.points", std::int64_t{level.cell_bricks} + 1,
               FindPoints{tree.view().levels[d], tree.levels[static_cast<std::size_t>(d) - 1].point_begin.data(),
                          point_keys, level.point_begin.view()});
    }
  }
}

}  // namespace build

template <exec::Space Exec>
SortedPoints sort_points(Exec& ex, ArrayView<const Vec3f> positions, ArrayView<const std::uint64_t> tie_break) {
  using namespace build;
  constexpr int kKeyBits = 3 * kPointBits;
  const std::int64_t n = positions.size;
  SortedPoints sorted{exec::make_buffer<std::uint64_t>(ex, n), exec::iota(ex, n)};
  for_each(ex, "octree.keys", n, PointKey{positions, sorted.keys.view()});
  sort_pairs(ex, "octree.sort", sorted.keys, sorted.order, kKeyBits);
  if (n < 2 || exec::reduce<std::int32_t>(ex, "octree.ties", n, RepeatsKey{sorted.keys.cview()}, Larger{}) == 0)
    return sorted;

  // Points share a key: sort by the tie break first, then, stably, by key again.
  sorted.keys.reset();
  sorted.order.reset();
  auto ties = exec::make_buffer<std::uint64_t>(ex, n);
  copy(ex, tie_break, ties.view());
  sorted.order = exec::iota(ex, n);
  sort_pairs(ex, "octree.ties", ties, sorted.order, 64);
  ties.reset();
  auto tied_positions = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, positions, sorted.order.cview(), tied_positions.view());
  sorted.keys = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "octree.keys", n, PointKey{tied_positions.cview(), sorted.keys.view()});
  tied_positions.reset();
  sort_pairs(ex, "octree.sort", sorted.keys, sorted.order, kKeyBits);
  return sorted;
}

template <exec::Space Exec>
OctreeData build_octree(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth) {
  using namespace build;
  OctreeData tree;
  tree.depth = depth;
  tree.levels.resize(static_cast<std::size_t>(depth) + 1);

  // Reverse level order (Listing 1): which bricks exist.
  BrickSets sets = find_brick_sets(ex, point_keys, depth);

  // Level order (Listing 2): who is whose neighbour.
  build_complete_levels(ex, tree, std::min(depth, kCompleteDepth));
  for (int d = kCompleteDepth + 1; d <= depth; ++d) {
    link_level(ex, tree, d, sets);
    sets.keys[static_cast<std::size_t>(d)].reset();
  }
  LevelData& finest = tree.levels.back();
  finest.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * finest.bricks);
  exec::fill(ex, finest.child_brick.view(), std::int32_t{-1});
  assign_points(ex, tree, point_keys);
  return tree;
}

}  // namespace pointskin::octree
