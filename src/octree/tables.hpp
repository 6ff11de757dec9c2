// Look-up tables for neighbours, derived at compile time.
// Source: Zhou et al. 2010, section 3.2, Listing 2: neighbour j of child i is child LUT_child[i][j] of the parent's
// neighbour LUT_parent[i][j].
#pragma once

#include <cstdint>

#include "octree/keys.hpp"

namespace pointskin::octree {

/// Both tables of the paper, indexed [slot of the node][neighbour index].
struct NeighbourTables {
  std::int8_t parent[8][kNeighbours];
  std::int8_t child[8][kNeighbours];
};

constexpr NeighbourTables make_neighbour_tables() {
  NeighbourTables tables{};
  for (int slot = 0; slot < 8; ++slot)
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const int j = neighbour_index(dx, dy, dz);
          const int x = slot_x(slot) + dx;
          const int y = slot_y(slot) + dy;
          const int z = slot_z(slot) + dz;
          // Shifting right rounds down, so -1 belongs to the lower neighbour and 2 to the upper one.
          tables.parent[slot][j] = static_cast<std::int8_t>(neighbour_index(x >> 1, y >> 1, z >> 1));
          tables.child[slot][j] = static_cast<std::int8_t>(slot_of(x & 1, y & 1, z & 1));
        }
  return tables;
}

inline constexpr NeighbourTables kNeighbourTables = make_neighbour_tables();

}  // namespace pointskin::octree
