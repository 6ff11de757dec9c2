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
  // All reads of a kind are asked for before any is waited for, and what is not there adds 0.
  std::int32_t corner[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s)
    corner[s] = (s & ~slot) != 0 ? -1 : level_above.neighbour(parent, slot_x(s), slot_y(s), slot_z(s));
  T value[8];  // corners of cells have all that are asked for; other nodes are never read
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) value[s] = corner[s] < 0 ? T{} : above[corner[s]];
  T sum{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) sum += value[s];
  return sum * (1.0F / static_cast<float>(1 << count_bits(static_cast<std::uint64_t>(slot))));
}

/// Sum over the 27 finer corners around node `n` of weight times value, weights 1, 1/2, 1/4, 1/8: the transpose of
/// prolonged(). Finer corners that do not exist count as zero.
/// @param values  anything that has the value of finer node i at [i]
template <class Values>
PSK_HD auto restricted(const LevelView& level, const LevelView& below, const Values& values, std::int32_t n) {
  using Value = std::decay_t<decltype(values[std::int64_t{0}])>;
  // All reads of a kind are asked for before any is waited for, and what is not there adds 0.
  std::int32_t node[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) node[s] = level.neighbour(n, -slot_x(s), -slot_y(s), -slot_z(s));
  std::int32_t brick[8];  // below node n - s: holds the finer corners -2 s, -2 s + 1 along each axis
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) brick[s] = node[s] < 0 ? -1 : level.child_brick[node[s]];
  Value sum{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const bool exists = brick[s] >= 0 && brick[s] < below.bricks;
    const std::int64_t first = std::int64_t{8} * brick[s];
    // Along an axis, the node's own brick gives offsets 0 and 1, the lower brick only offset -1 (its slot 1).
    PSK_UNROLL
    for (int i = 0; i < 2; ++i) {
      PSK_UNROLL
      for (int j = 0; j < 2; ++j) {
        PSK_UNROLL
        for (int k = 0; k < 2; ++k) {
          if (i < slot_x(s) || j < slot_y(s) || k < slot_z(s)) continue;
          const int distance = (i != 0) + (j != 0) + (k != 0);
          const Value value = exists ? values[first + slot_of(i, j, k)] : Value{};
          sum += value * (distance == 0 ? 1.0F : distance == 1 ? 0.5F : distance == 2 ? 0.25F : 0.125F);
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

/// Descends from the complete levels, whose cells come in Morton order, to level `last` or to the leaf above it. O(depth).
PSK_HD inline Leaf locate(const OctreeView& tree, std::uint64_t point_key, int last) {
  const int shallower = last < tree.depth ? last : tree.depth;
  Leaf leaf{shallower < kCompleteDepth ? shallower : kCompleteDepth, 0};
  leaf.cell = static_cast<std::int32_t>(cell_key(point_key, leaf.depth));
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
