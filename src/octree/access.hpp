// Moving values between the corners of a level, its parents and points. All are linear in the corners' values and
// use the same order of operations everywhere. A value is a float, or several that add and scale one by one.
#pragma once

#include <cstdint>
#include <type_traits>

#include <pointskin/vector.hpp>

#include "core/bits.hpp"
#include "core/host_device.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// Value at node `slot` of a brick whose parent node is `parent`, interpolated from the corners `above` of the level
/// above: the mean of the 1, 2, 4 or 8 corners around it. Exact for hat functions, whose spaces are nested.
template <class T>
PSK_HD T prolonged(const LevelView& level_above, const T* above, std::int32_t parent, int slot) {
  T sum{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    if ((s & ~slot) != 0) continue;
    const std::int32_t corner = level_above.neighbour(parent, slot_x(s), slot_y(s), slot_z(s));
    if (corner >= 0) sum += above[corner];  // corners of cells have all; other nodes are never read
  }
  return sum * (1.0F / static_cast<float>(1 << count_bits(static_cast<std::uint64_t>(slot))));
}

/// Sum over the 27 finer corners around node `n` of weight times value, weights 1, 1/2, 1/4, 1/8: the transpose of
/// prolonged(). Finer corners that do not exist count as zero.
/// @param values  anything that has the value of finer node i at [i]
template <class Values>
PSK_HD auto restricted(const LevelView& level, const LevelView& below, const Values& values, std::int32_t n) {
  std::decay_t<decltype(values[std::int64_t{0}])> sum{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {  // the brick below node n - s holds finer corners -2 s, -2 s + 1 along each axis
    const int x = slot_x(s);
    const int y = slot_y(s);
    const int z = slot_z(s);
    const std::int32_t node = level.neighbour(n, -x, -y, -z);
    const std::int32_t brick = node < 0 ? -1 : level.child_brick[node];
    if (brick < 0 || brick >= below.bricks) continue;
    const std::int64_t first = std::int64_t{8} * brick;
    // Along an axis, the node's own brick gives offsets 0 and 1, the lower brick only offset -1 (its slot 1).
    PSK_UNROLL
    for (int i = 0; i < 2; ++i) {
      PSK_UNROLL
      for (int j = 0; j < 2; ++j) {
        PSK_UNROLL
        for (int k = 0; k < 2; ++k) {
          if (i < x || j < y || k < z) continue;
          const int distance = (i != 0) + (j != 0) + (k != 0);
          sum += values[first + slot_of(i, j, k)] * (distance == 0   ? 1.0F
                                                     : distance == 1 ? 0.5F
                                                     : distance == 2 ? 0.25F
                                                                     : 0.125F);
        }
      }
    }
  }
  return sum;
}

/// Trilinear weight of corner `slot` at local coordinates (x, y, z) of a cell.
PSK_HD inline float corner_weight(int slot, const Vec3f& local) {
  return (slot_x(slot) != 0 ? local.x : 1 - local.x) * (slot_y(slot) != 0 ? local.y : 1 - local.y) *
         (slot_z(slot) != 0 ? local.z : 1 - local.z);
}

/// Local coordinates in [0, 1] of a point of the unit cube in the cell at `c` of level `depth`.
PSK_HD inline Vec3f local_in_cell(const Vec3f& p, const Coordinates& c, int depth) {
  const auto scale = static_cast<float>(1 << depth);
  const auto clamp = [](float v) { return v < 0 ? 0.0F : v > 1 ? 1.0F : v; };
  return {clamp(p.x * scale - static_cast<float>(c.x)), clamp(p.y * scale - static_cast<float>(c.y)),
          clamp(p.z * scale - static_cast<float>(c.z))};
}

/// Trilinear interpolation of corner values in a cell.
template <class T>
PSK_HD T interpolated(const LevelView& level, const T* values, std::int32_t cell, const Vec3f& local) {
  T sum{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s)
    sum += values[level.neighbour(cell, slot_x(s), slot_y(s), slot_z(s))] * corner_weight(s, local);
  return sum;
}

/// Deepest cell that holds a point of the unit cube.
struct Leaf {
  int depth = 0;
  std::int32_t cell = 0;
};

/// Descends from the root to level `last` or to the leaf above it. O(depth).
PSK_HD inline Leaf locate(const OctreeView& tree, std::uint64_t point_key, int last) {
  Leaf leaf;
  while (leaf.depth < last && tree.is_split(leaf.depth, leaf.cell)) {
    const std::int32_t brick = tree.levels[leaf.depth].child_brick[leaf.cell];
    ++leaf.depth;
    leaf.cell = 8 * brick + static_cast<std::int32_t>(cell_key(point_key, leaf.depth) & 7);
  }
  return leaf;
}

/// Value of corner values over all levels (level-major) at a point of the unit cube: one trilinear interpolation in the
/// deepest cell no finer than `last`.
template <class T>
PSK_HD T value_at(const OctreeView& tree, const T* values, const Vec3f& p, int last) {
  const std::uint64_t key = point_key(p.x, p.y, p.z);
  const Leaf leaf = locate(tree, key, last);
  const LevelView& level = tree.levels[leaf.depth];
  const Vec3f local = local_in_cell(p, decode(cell_key(key, leaf.depth)), leaf.depth);
  return interpolated(level, values + level.first_node, leaf.cell, local);
}

}  // namespace pointskin::octree
