// How many bricks an octree would have, counted without building it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"

namespace pointskin::octree {

/// Bricks of one level, as build_octree would make them.
struct BrickCounts {
  std::int64_t cell_bricks = 0;
  std::int64_t bricks = 0;          ///< with ghosts
  std::int64_t occupied_cells = 0;  ///< cells that hold points: as many bricks of the next level do
};

/// Counts the bricks of levels 0..depth exactly, from the keys of the points alone: holds the keys of the cell bricks
/// and a bitmap of one level, at most 5 bytes a node, and what finding the keys takes, but no level.
/// @param point_keys  shape (n), ascending in their first 3 depth bits, n >= 0
/// @param depth       D in [1, kMaxDepth]
/// @returns depth + 1 counts, level 0 first
/// @throws Error over_limit if a level would need more than 2^31 / 8 bricks, or memory runs out
/// O(n depth + nodes log nodes).
std::vector<BrickCounts> count_bricks(exec::Cpu& ex, ArrayView<const std::uint64_t> point_keys, int depth);

}  // namespace pointskin::octree
