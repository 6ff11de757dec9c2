// The finest level of an octree over particles, alone: neighbours within a radius are in the 27 cells around.
//
// Octrees for fields (octree/octree_data.hpp) pad their finest level, so that every corner has an owner, and have
// levels above. Neighbours need neither: a cell that does not exist is empty. So there are bricks of cells that hold
// particles and nothing else, and who is whose neighbour is looked up, in a table or among the sorted keys. Source:
// Zhou et al. 2010, section 3 (keys, bricks of siblings, 27 neighbours); Green, "Particle simulation using CUDA", 2010
// (cells as wide as the radius, particles sorted by cell).
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "octree/view.hpp"

namespace pointskin::fluid {

/// A cube of 2^depth cells along every axis.
struct CellGrid {
  octree::Frame cube;
  int depth = 1;  ///< in [1, octree::kMaxDepth]
};

/// The smallest such cube around a box whose cells are a little wider than `radius`, so that rounding never parts two
/// particles within it; wider where kMaxDepth would be too coarse. The box lies in its middle.
/// @param radius  > 0, world units
CellGrid grid_around(const Bounds& box, double radius);

/// The tree as kernels see it; small enough to travel as an argument.
struct ParticleTreeView {
  octree::Frame cube;
  octree::LevelView level;  ///< bricks of occupied cells, sorted by key; no ghosts, parents, children or unknowns
  const std::int32_t* table = nullptr;  ///< (8^(depth - 1)) brick with this key or -1; null: look it up in brick_key
  const std::int32_t* cell = nullptr;   ///< (particles) cell of each

  /// Id of the brick with a key, or -1. One read, or O(log bricks).
  [[nodiscard]] PSK_HD std::int32_t brick_at(std::uint64_t key) const {
    if (table != nullptr) return table[key];
    std::int32_t low = 0;
    std::int32_t high = level.bricks;
    while (low < high) {
      const std::int32_t middle = low + (high - low) / 2;
      if (level.brick_key[middle] < key)
        low = middle + 1;
      else
        high = middle;
    }
    return low < level.bricks && level.brick_key[low] == key ? low : -1;
  }
};

/// Owns the tree in the space it was built in.
struct ParticleTree {
  CellGrid grid;
  exec::Buffer<std::uint64_t> keys;        ///< (n) key of each particle's cell, ascending
  exec::Buffer<std::int32_t> order;        ///< (n) index in the caller's order
  exec::Buffer<std::int32_t> cell;         ///< (n) in the order of the keys
  exec::Buffer<std::uint64_t> brick_key;   ///< (bricks)
  exec::Buffer<std::int32_t> neighbours;   ///< (bricks, 27)
  exec::Buffer<std::int32_t> point_begin;  ///< (8 bricks + 1)
  exec::Buffer<std::int32_t> table;        ///< ParticleTreeView::table, or (0)

  [[nodiscard]] ParticleTreeView view() const;
};

/// Sorts particles into the cells of a grid. Particles of one cell keep the caller's order; those outside of the cube
/// count to the cells at its faces, where their neighbours still are.
/// @param positions  shape (n), n < 2^31, world units, finite
/// O(n), and 4 bytes for every brick of the cube while those are few; some 13 launches and one host round trip on a
/// GPU. Integers after the rounding into the cube: the same on every device.
/// @throws Error over_limit if memory runs out
template <exec::Space Exec>
ParticleTree build_particle_tree(Exec& ex, ArrayView<const Vec3f> positions, const CellGrid& grid);

/// Calls visit(first, last) for ranges of particles, in the order of the keys, that together are those in the 27 cells
/// around a cell: by ascending x, y, z of the cells. Siblings along z are one range.
template <class Visit>
PSK_HD void for_each_range_around(const octree::LevelView& level, std::int32_t cell, const Visit& visit) {
  const int slot = cell & 7;
  const std::int32_t* around = level.neighbours + std::int64_t{cell >> 3} * octree::kNeighbours;
  const bool upper = octree::slot_z(slot) != 0;
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy) {
      const int x = octree::slot_x(slot) + dx;
      const int y = octree::slot_y(slot) + dy;
      const int column = octree::slot_of(x & 1, y & 1, 0);
      const std::int32_t own = around[octree::neighbour_index(x >> 1, y >> 1, 0)];
      const std::int32_t other = around[octree::neighbour_index(x >> 1, y >> 1, upper ? 1 : -1)];
      const auto visit_own = [&] {
        if (own >= 0) visit(level.point_begin[8 * own + column], level.point_begin[8 * own + column + 2]);
      };
      if (upper) visit_own();
      if (other >= 0) {
        const std::int32_t end = 8 * other + column + (upper ? 0 : 1);
        visit(level.point_begin[end], level.point_begin[end + 1]);
      }
      if (!upper) visit_own();
    }
}

/// Calls visit(j) for every particle j (in the order of the keys) of the 27 cells around a cell, which hold all that
/// are within the grid's radius of its particles, and more. The order is fixed.
template <class Visit>
PSK_HD void for_each_neighbour(const ParticleTreeView& tree, std::int32_t cell, const Visit& visit) {
  for_each_range_around(tree.level, cell, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t j = first; j < last; ++j) visit(j);
  });
}

/// The same around any place, whose cell may be empty. Places outside of the cube count to the cells at its faces.
/// Eight look-ups of bricks.
template <class Visit>
PSK_HD void for_each_near(const ParticleTreeView& tree, const Vec3f& place, const Visit& visit) {
  const Vec3f unit = tree.cube.to_unit(place);
  const int depth = tree.level.depth;
  const octree::Coordinates c = octree::decode(octree::cell_key(octree::point_key(unit.x, unit.y, unit.z), depth));
  const std::int32_t last_brick = (1 << (depth - 1)) - 1;
  for (int x = (c.x - 1) >> 1; x <= (c.x + 1) >> 1; ++x)
    for (int y = (c.y - 1) >> 1; y <= (c.y + 1) >> 1; ++y)
      for (int z = (c.z - 1) >> 1; z <= (c.z + 1) >> 1; ++z) {
        if (x < 0 || y < 0 || z < 0 || x > last_brick || y > last_brick || z > last_brick) continue;
        const std::int32_t brick = tree.brick_at(octree::encode({x, y, z}));
        if (brick < 0) continue;
        for (int slot = 0; slot < 8; ++slot) {
          const int dx = 2 * x + octree::slot_x(slot) - c.x;
          const int dy = 2 * y + octree::slot_y(slot) - c.y;
          const int dz = 2 * z + octree::slot_z(slot) - c.z;
          if (dx < -1 || dy < -1 || dz < -1 || dx > 1 || dy > 1 || dz > 1) continue;
          const std::int32_t end = tree.level.point_begin[8 * brick + slot + 1];
          for (std::int32_t j = tree.level.point_begin[8 * brick + slot]; j < end; ++j) visit(j);
        }
      }
}

}  // namespace pointskin::fluid
