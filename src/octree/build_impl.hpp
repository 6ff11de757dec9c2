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

struct ToCellKey {
  ArrayView<const std::uint64_t> point_keys;
  ArrayView<const std::int32_t> first_points;
  int depth;
  ArrayView<std::uint64_t> cells;
  PSK_HD void operator()(std::int64_t i) const { cells[i] = cell_key(point_keys[first_points[i]], depth); }
};

/// Keeps the first point of every occupied cell.
struct StartsCell {
  ArrayView<const std::uint64_t> point_keys;
  int depth;
  PSK_HD bool operator()(std::int64_t i) const {
    return i == 0 || cell_key(point_keys[i], depth) != cell_key(point_keys[i - 1], depth);
  }
};

/// The up to 8 bricks that the 27-neighbourhood of cell i touches; candidates outside of the cube repeat an inner one.
struct TouchedBricks {
  ArrayView<const std::uint64_t> cells;
  std::int32_t bricks_per_axis;
  ArrayView<std::uint64_t> touched;

  PSK_HD std::int32_t brick(std::int32_t cell, int side) const {
    const std::int32_t b = (cell + (side == 0 ? -1 : 1)) >> 1;
    return b < 0 ? 0 : b >= bricks_per_axis ? bricks_per_axis - 1 : b;
  }
  PSK_HD void operator()(std::int64_t i) const {
    const Coordinates c = decode(cells[i]);
    for (int s = 0; s < 8; ++s)
      touched[8 * i + s] = encode({brick(c.x, slot_x(s)), brick(c.y, slot_y(s)), brick(c.z, slot_z(s))});
  }
};

struct AllBricks {
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const { keys[i] = static_cast<std::uint64_t>(i); }
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
  ArrayView<const std::int32_t> ghost_parents;
  std::int32_t first;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> parent;
  ArrayView<std::int32_t> child_brick_above;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t node = ghost_parents[i];
    keys[first + i] = above.node_key(node);
    parent[first + i] = node;
    child_brick_above[node] = static_cast<std::int32_t>(first + i);
  }
};

/// Listing 2 of the paper, on bricks.
struct FindNeighbours {
  LevelView above;  // complete
  NeighbourTables tables;
  ArrayView<const std::int32_t> parent;
  ArrayView<std::int32_t> neighbours;
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

/// A corner is an unknown if all cells around it that lie in the cube are cells of this level.
struct FindUnknowns {
  LevelView level;
  ArrayView<std::uint8_t> unknowns;

  /// Cells of the cube around coordinate c of an axis: bit 0 the lower one, bit 1 the upper one.
  PSK_HD int in_cube(std::int32_t c) const { return (c > 0 ? 1 : 0) | (c < (1 << level.depth) ? 2 : 0); }

  PSK_HD bool is_unknown(std::int32_t node) const {
    const Coordinates c = decode(level.node_key(node));
    const std::int32_t last = 1 << level.depth;
    if (c.x > last || c.y > last || c.z > last) return false;
    const int sides[3] = {in_cube(c.x), in_cube(c.y), in_cube(c.z)};
    for (int s = 0; s < 8; ++s) {
      const int d[3] = {slot_x(s), slot_y(s), slot_z(s)};
      if (((sides[0] >> d[0]) & (sides[1] >> d[1]) & (sides[2] >> d[2]) & 1) == 0) continue;
      if (!level.is_cell(level.neighbour(node, d[0] - 1, d[1] - 1, d[2] - 1))) return false;
    }
    return true;
  }
  PSK_HD void operator()(std::int64_t b) const {
    int mask = 0;
    for (int s = 0; s < 8; ++s) mask |= is_unknown(static_cast<std::int32_t>(8 * b + s)) ? 1 << s : 0;
    unknowns[b] = static_cast<std::uint8_t>(mask);
  }
};

/// Number of points of the finest cells, from the occupied ones.
struct CountPoints {
  ArrayView<const std::int32_t> first_points;  // of the occupied cells
  ArrayView<const std::uint64_t> cells;        // their keys
  ArrayView<const std::uint64_t> brick_keys;   // of the cell bricks
  std::int64_t points;
  ArrayView<std::int32_t> count;  // zero before
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t end = i + 1 < first_points.size ? first_points[i + 1] : points;
    count[find_node(brick_keys, cells[i])] = static_cast<std::int32_t>(end - first_points[i]);
  }
};

/// Number of points of cells above the finest level: that of their children.
struct SumPoints {
  LevelView level;
  const std::int32_t* below_begin;
  std::int32_t below_cell_bricks;
  ArrayView<std::int32_t> count;
  PSK_HD void operator()(std::int64_t node) const {
    const std::int32_t brick = level.child_brick[node];
    const bool split = brick >= 0 && brick < below_cell_bricks;
    count[node] = split ? below_begin[8 * std::int64_t{brick} + 8] - below_begin[8 * std::int64_t{brick}] : 0;
  }
};

inline void check_limit(std::int64_t bricks, int depth) {
  if (bricks > std::numeric_limits<std::int32_t>::max() / 8)
    throw Error(ErrorCode::over_limit, "level " + std::to_string(depth) + " of the octree needs " +
                                           std::to_string(bricks) +
                                           " bricks, more than 32-bit node ids reach; "
                                           "choose a smaller depth");
}

/// Keys of the cell bricks of level `depth`, given the sorted keys of the cells that they must surround.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> cell_bricks_around(Exec& ex, ArrayView<const std::uint64_t> cells, int depth) {
  check_limit(cells.size, depth);  // eight candidates a cell are counted with 32 bits
  auto touched = exec::make_buffer<std::uint64_t>(ex, 8 * cells.size);
  for_each(ex, "octree.touch", cells.size, TouchedBricks{cells, 1 << (depth - 1), touched.view()});
  exec::Buffer<std::uint64_t> bricks = exec::sort_unique(ex, "octree.bricks", std::move(touched), 3 * (depth - 1));
  check_limit(bricks.size(), depth);
  return bricks;
}

/// Keys of all bricks of a complete level.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> complete_bricks(Exec& ex, int depth) {
  auto keys = exec::make_buffer<std::uint64_t>(ex, depth == 0 ? 1 : std::int64_t{1} << 3 * (depth - 1));
  for_each(ex, "octree.complete", keys.size(), AllBricks{keys.view()});
  return keys;
}

/// The finest level's cells that hold points.
struct OccupiedCells {
  exec::Buffer<std::int32_t> first_points;
  exec::Buffer<std::uint64_t> keys;
};

template <exec::Space Exec>
OccupiedCells find_occupied(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth) {
  OccupiedCells occupied;
  occupied.first_points = select(ex, "octree.occupied", point_keys.size, StartsCell{point_keys, depth});
  occupied.keys = exec::make_buffer<std::uint64_t>(ex, occupied.first_points.size());
  for_each(ex, "octree.occupied", occupied.keys.size(),
           ToCellKey{point_keys, occupied.first_points.cview(), depth, occupied.keys.view()});
  return occupied;
}

/// Ghost bricks, ids, neighbours and unknowns of level `d`, whose cell brick keys are given. Levels above are complete.
template <exec::Space Exec>
void link_level(Exec& ex, OctreeData& tree, int d, const exec::Buffer<std::uint64_t>& cell_keys) {
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
  const exec::Buffer<std::int32_t> ghosts = select(ex, "octree.ghosts", above_view.nodes(), NeedsGhost{above_view});
  check_limit(cell_bricks + ghosts.size(), d);
  level.cell_bricks = cell_bricks;
  level.bricks = static_cast<std::int32_t>(cell_bricks + ghosts.size());
  level.brick_key = exec::make_buffer<std::uint64_t>(ex, level.bricks);
  level.parent = exec::make_buffer<std::int32_t>(ex, level.bricks);
  copy(ex, cell_keys.cview(), level.brick_key.view().part(0, cell_bricks));
  copy(ex, cell_parents.cview(), level.parent.view().part(0, cell_bricks));
  for_each(ex, "octree.ghosts", ghosts.size(),
           AddGhost{above_view, ghosts.cview(), cell_bricks, level.brick_key.view(), level.parent.view(),
                    above.child_brick.view()});

  level.neighbours = exec::make_buffer<std::int32_t>(ex, std::int64_t{kNeighbours} * level.bricks);
  for_each(ex, "octree.neighbours", level.bricks,
           FindNeighbours{above_view, kNeighbourTables, level.parent.cview(), level.neighbours.view()});
  level.unknowns = exec::make_buffer<std::uint8_t>(ex, level.bricks);
  for_each(ex, "octree.unknowns", level.bricks, FindUnknowns{tree.view().levels[d], level.unknowns.view()});
}

/// Level 0: the root cell, and the owners of the cube's other corners.
template <exec::Space Exec>
void make_root(Exec& ex, LevelData& root) {
  root.cell_bricks = 1;
  root.bricks = 1;
  root.brick_key = complete_bricks(ex, 0);
  root.parent = exec::make_buffer<std::int32_t>(ex, 1);
  exec::fill(ex, root.parent.view(), std::int32_t{-1});
  root.neighbours = exec::make_buffer<std::int32_t>(ex, kNeighbours);
  exec::fill(ex, root.neighbours.view(), std::int32_t{-1});
  exec::fill(ex, root.neighbours.view().part(kSelf, 1), std::int32_t{0});
  root.unknowns = exec::make_buffer<std::uint8_t>(ex, 1);
  exec::fill(ex, root.unknowns.view(), std::uint8_t{0xff});
}

/// Point ranges of all cells, finest level first.
template <exec::Space Exec>
void assign_points(Exec& ex, OctreeData& tree, const OccupiedCells& occupied, std::int64_t points) {
  for (int d = tree.depth; d >= 0; --d) {
    LevelData& level = tree.levels[static_cast<std::size_t>(d)];
    const std::int64_t cells = std::int64_t{8} * level.cell_bricks;
    auto count = exec::make_buffer<std::int32_t>(ex, cells);
    if (d == tree.depth) {
      exec::fill(ex, count.view(), std::int32_t{0});
      for_each(ex, "octree.points", occupied.keys.size(),
               CountPoints{occupied.first_points.cview(), occupied.keys.cview(),
                           level.brick_key.cview().part(0, level.cell_bricks), points, count.view()});
    } else {
      const LevelData& below = tree.levels[static_cast<std::size_t>(d) + 1];
      for_each(ex, "octree.points", cells,
               SumPoints{tree.view().levels[d], below.point_begin.data(), below.cell_bricks, count.view()});
    }
    level.point_begin = exec::make_buffer<std::int32_t>(ex, cells + 1);
    exclusive_scan(ex, "octree.points", count.cview(), level.point_begin.view());
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
  auto ties = exec::make_buffer<std::uint64_t>(ex, n);
  copy(ex, tie_break, ties.view());
  sorted.order = exec::iota(ex, n);
  sort_pairs(ex, "octree.ties", ties, sorted.order, 64);
  auto tied_positions = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, positions, sorted.order.cview(), tied_positions.view());
  for_each(ex, "octree.keys", n, PointKey{tied_positions.cview(), sorted.keys.view()});
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
  const OccupiedCells occupied = find_occupied(ex, point_keys, depth);
  std::vector<exec::Buffer<std::uint64_t>> cell_keys(static_cast<std::size_t>(depth) + 1);
  for (int d = depth; d > 0; --d) {
    auto& keys = cell_keys[static_cast<std::size_t>(d)];
    if (d <= kCompleteDepth)
      keys = complete_bricks(ex, d);
    else if (d == depth)
      keys = cell_bricks_around(ex, occupied.keys.cview(), d);
    else  // the key of a brick is the key of its parent cell, which has children
      keys = cell_bricks_around(ex, cell_keys[static_cast<std::size_t>(d) + 1].cview(), d);
  }

  // Level order (Listing 2): who is whose neighbour.
  make_root(ex, tree.levels[0]);
  for (int d = 1; d <= depth; ++d) {
    link_level(ex, tree, d, cell_keys[static_cast<std::size_t>(d)]);
    cell_keys[static_cast<std::size_t>(d)].reset();
  }
  LevelData& finest = tree.levels.back();
  finest.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * finest.bricks);
  exec::fill(ex, finest.child_brick.view(), std::int32_t{-1});
  assign_points(ex, tree, occupied, point_keys.size);
  return tree;
}

}  // namespace pointskin::octree
