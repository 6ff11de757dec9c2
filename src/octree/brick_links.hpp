// Who is whose neighbour on a level, when the level above is known.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "octree/tables.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

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

}  // namespace pointskin::octree
