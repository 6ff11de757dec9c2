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

/// Calls visit(first, last) for ranges of particles that together are those in the cells of a box, by ascending x, y, z
/// of the cells: two boxes visit what they share in the same order. Cells outside of the cube are empty.
template <class Visit>
PSK_HD void for_each_range_in(const ParticleTreeView& tree, const octree::Coordinates& lower,
                              const octree::Coordinates& upper, const Visit& visit) {
  const std::int32_t last = (1 << tree.level.depth) - 1;
  const auto clamped_low = [](std::int32_t c) { return c < 0 ? 0 : c; };
  const auto clamped_high = [&](std::int32_t c) { return c > last ? last : c; };
  for (std::int32_t x = clamped_low(lower.x); x <= clamped_high(upper.x); ++x)
    for (std::int32_t y = clamped_low(lower.y); y <= clamped_high(upper.y); ++y)
      for (std::int32_t z = clamped_low(lower.z); z <= clamped_high(upper.z);) {
        const std::int32_t brick = tree.brick_at(octree::encode({x >> 1, y >> 1, z >> 1}));
        const int count = (z & 1) == 0 && z < clamped_high(upper.z) ? 2 : 1;  // siblings along z are one range
        const std::int32_t first = 8 * brick + octree::slot_of(x & 1, y & 1, z & 1);
        if (brick >= 0) visit(tree.level.point_begin[first], tree.level.point_begin[first + count]);
        z += count;
      }
}

/// Cell, maybe outside of the cube, that a coordinate in units of cells lies in. Places far outside keep their side.
PSK_HD inline std::int32_t cell_coordinate(double cells) {
  constexpr double kFar = 1 << 24;
  if (!(cells > -kFar)) return -(1 << 24);
  if (cells > kFar) return 1 << 24;
  const auto truncated = static_cast<std::int32_t>(cells);
  return static_cast<double>(truncated) > cells ? truncated - 1 : truncated;
}

/// Calls visit(first, last) for ranges that hold all particles within `radius` of the box from `lower` to `upper`, in
/// the order of for_each_range_in. Any radius.
/// @param lower, upper, radius  world units
template <class Visit>
PSK_HD void for_each_range_near(const ParticleTreeView& tree, const Vec3f& lower, const Vec3f& upper, double radius,
                                const Visit& visit) {
  const double scale = static_cast<double>(std::int64_t{1} << tree.level.depth) / tree.cube.size;
  // Particles were rounded to floats of the unit cube before they were sorted into cells.
  const double slack = static_cast<double>(std::int64_t{1} << tree.level.depth) * 1.2e-7;
  const double reach = radius * scale + slack;
  const auto cell = [&](float v, double origin, double step) {
    return cell_coordinate((static_cast<double>(v) - origin) * scale + step);
  };
  const Vec3d& o = tree.cube.lower;
  const std::int32_t last = (1 << tree.level.depth) - 1;
  const auto inside = [&](std::int32_t c) { return c < 0 ? 0 : c > last ? last : c; };
  for_each_range_in(
      tree,
      {inside(cell(lower.x, o[0], -reach)), inside(cell(lower.y, o[1], -reach)), inside(cell(lower.z, o[2], -reach))},
      {inside(cell(upper.x, o[0], reach)), inside(cell(upper.y, o[1], reach)), inside(cell(upper.z, o[2], reach))},
      visit);
}

}  // namespace pointskin::fluid
