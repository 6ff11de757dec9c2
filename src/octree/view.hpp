// The octree as algorithms see it: levels of bricks, with everything reachable by small integer arithmetic.
//
// A brick is the 8 siblings under one parent; brick b of a level holds nodes 8 b .. 8 b + 7 of that level, in Morton
// order. Node n stands for a cell and for the corner, edges and faces that start at its lower corner (the owner rule,
// P3). The first `cell_bricks` bricks of a level are cells of the tree, sorted by key; the others are ghosts: they lie
// one step above some cell and only own the corners, edges and faces there. Level 0 is one brick whose node 0 is the
// root cell and whose other nodes own the upper corners of the cube.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "octree/keys.hpp"

namespace pointskin::octree {

/// One level. All ids are local to the level; -1 stands for "does not exist".
struct LevelView {
  int depth = 0;
  std::int32_t cell_bricks = 0;  ///< bricks whose nodes are cells
  std::int32_t bricks = 0;       ///< all bricks, ghosts last
  std::int32_t near_ghosts = 0;  ///< of the ghosts, the first: in the order of the cells; others follow anew
  std::int64_t first_node = 0;   ///< of this level in arrays over the nodes of all levels
  const std::uint64_t* brick_key = nullptr;   ///< (bricks) key of the parent node, i.e. of the brick's own coordinates
  const std::int32_t* parent = nullptr;       ///< (bricks) parent node on level depth - 1
  const std::int32_t* neighbours = nullptr;   ///< (bricks, 27) bricks around, by neighbour_index
  const std::int32_t* child_brick = nullptr;  ///< (8 bricks) brick, cell or ghost, below the node; the finest has none
  const std::uint8_t* unknowns = nullptr;     ///< (bricks) bit s: the corner of node s has all its cells of this level
  const std::int32_t* point_begin = nullptr;  ///< (8 cell_bricks + 1) first point of each cell, in point order

  PSK_HD std::int64_t nodes() const { return std::int64_t{8} * bricks; }
  /// Number of cells: nodes [0, cells()) are cells of the tree.
  PSK_HD std::int64_t cells() const { return depth == 0 ? 1 : std::int64_t{8} * cell_bricks; }
  PSK_HD bool is_cell(std::int64_t node) const { return node >= 0 && node < cells(); }

  /// Node at an offset of up to two nodes along each axis, or -1.
  PSK_HD std::int32_t neighbour(std::int32_t node, int dx, int dy, int dz) const {
    const int slot = node & 7;
    const int x = slot_x(slot) + dx;
    const int y = slot_y(slot) + dy;
    const int z = slot_z(slot) + dz;
    const std::int32_t brick =
        neighbours[std::int64_t{node >> 3} * kNeighbours + neighbour_index(x >> 1, y >> 1, z >> 1)];
    return brick < 0 ? -1 : brick * 8 + slot_of(x & 1, y & 1, z & 1);
  }

  PSK_HD std::uint64_t node_key(std::int32_t node) const { return brick_key[node >> 3] << 3 | (node & 7); }
};

/// All levels. Small enough to travel as a kernel's argument.
struct OctreeView {
  int depth = 0;
  std::int64_t nodes = 0;  ///< of all levels
  LevelView levels[kMaxDepth + 1];

  PSK_HD const LevelView& finest() const { return levels[depth]; }

  /// True if the cell has children (ghost bricks below a node are not children).
  PSK_HD bool is_split(int level, std::int64_t node) const {
    if (level >= depth || !levels[level].is_cell(node)) return false;
    const std::int32_t brick = levels[level].child_brick[node];
    return brick >= 0 && brick < levels[level + 1].cell_bricks;
  }

  /// Level that holds node `index` of arrays over all levels. Most nodes are on the finest one.
  PSK_HD int level_of(std::int64_t index) const {
    int level = depth;
    while (index < levels[level].first_node) --level;
    return level;
  }
};

}  // namespace pointskin::octree
