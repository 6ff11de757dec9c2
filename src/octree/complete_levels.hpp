// The complete levels in closed form: every brick knows its id, its neighbours and its family from its coordinates.
// Cell bricks come in Morton order; ghost bricks fill the three upper sides of the grid, x first, then y, then z.
#pragma once

#include <algorithm>
#include <cstdint>

#include "exec/algorithms.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::octree {
namespace complete {

/// Cell bricks along an axis; the root's brick stands alone.
PSK_HD constexpr std::int32_t side(int depth) { return depth == 0 ? 1 : 1 << (depth - 1); }

PSK_HD constexpr std::int32_t cell_bricks(int depth) { return side(depth) * side(depth) * side(depth); }

PSK_HD constexpr std::int32_t bricks(int depth) {
  const std::int32_t s = side(depth) + 1;
  return depth == 0 ? 1 : s * s * s;
}

/// Id of the brick at these coordinates, or -1.
PSK_HD inline std::int32_t brick_at(const Coordinates& c, int depth) {
  const std::int32_t s = side(depth);
  const std::int32_t last = depth == 0 ? 0 : s;
  if (c.x < 0 || c.y < 0 || c.z < 0 || c.x > last || c.y > last || c.z > last) return -1;
  if (c.x < s && c.y < s && c.z < s) return static_cast<std::int32_t>(encode(c));
  const std::int32_t first = s * s * s;
  const std::int32_t t = s + 1;
  if (c.x == s) return first + c.y * t + c.z;
  if (c.y == s) return first + t * t + c.x * t + c.z;
  return first + t * t + s * t + c.x * s + c.y;
}

/// Inverse of brick_at.
PSK_HD inline Coordinates coordinates_of(std::int32_t brick, int depth) {
  const std::int32_t s = side(depth);
  const std::int32_t t = s + 1;
  if (brick < s * s * s) return decode(static_cast<std::uint64_t>(brick));
  std::int32_t ghost = brick - s * s * s;
  if (ghost < t * t) return {s, ghost / t, ghost % t};
  ghost -= t * t;
  if (ghost < s * t) return {ghost / t, s, ghost % t};
  ghost -= s * t;
  return {ghost / s, ghost % s, s};
}

/// The arrays of one level; child_brick is null where the level below is not complete.
struct Arrays {
  std::uint64_t* brick_key;
  std::int32_t* parent;
  std::int32_t* neighbours;
  std::int32_t* child_brick;
  std::uint8_t* unknowns;
};

/// Fills everything that belongs to brick i of the complete levels, counted from the root.
struct FillBrick {
  Arrays levels[kCompleteDepth + 1];

  PSK_HD void operator()(std::int64_t i) const {
    int depth = 0;
    auto brick = static_cast<std::int32_t>(i);
    while (brick >= bricks(depth)) brick -= bricks(depth++);
    const Arrays& level = levels[depth];
    const Coordinates c = coordinates_of(brick, depth);
    level.brick_key[brick] = encode(c);
    level.parent[brick] =
        depth == 0 ? -1 : 8 * brick_at({c.x >> 1, c.y >> 1, c.z >> 1}, depth - 1) + slot_of(c.x & 1, c.y & 1, c.z & 1);
    for (int j = 0; j < kNeighbours; ++j)
      level.neighbours[std::int64_t{brick} * kNeighbours + j] =
          brick_at({c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1}, depth);
    int unknowns = 0;
    for (int s = 0; s < 8; ++s) {
      const Coordinates node{2 * c.x + slot_x(s), 2 * c.y + slot_y(s), 2 * c.z + slot_z(s)};
      const std::int32_t child = brick_at(node, depth + 1);
      if (child >= 0) unknowns |= 1 << s;  // corners of the cube's grid: all of them have their cells
      if (level.child_brick != nullptr) level.child_brick[8 * brick + s] = child;
    }
    level.unknowns[brick] = static_cast<std::uint8_t>(unknowns);
  }
};

}  // namespace complete

/// Builds levels 0..last <= kCompleteDepth, except the child bricks of the last one. One launch.
template <exec::Space Exec>
void build_complete_levels(Exec& ex, OctreeData& tree, int last) {
  complete::FillBrick fill{};
  std::int64_t bricks = 0;
  for (int d = 0; d <= last; ++d) {
    LevelData& level = tree.levels[static_cast<std::size_t>(d)];
    level.cell_bricks = complete::cell_bricks(d);
    level.bricks = complete::bricks(d);
    level.brick_key = exec::make_buffer<std::uint64_t>(ex, level.bricks);
    level.parent = exec::make_buffer<std::int32_t>(ex, level.bricks);
    level.neighbours = exec::make_buffer<std::int32_t>(ex, std::int64_t{kNeighbours} * level.bricks);
    level.unknowns = exec::make_buffer<std::uint8_t>(ex, level.bricks);
    if (d < last) level.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * level.bricks);
    fill.levels[d] = {level.brick_key.data(), level.parent.data(), level.neighbours.data(), level.child_brick.data(),
                      level.unknowns.data()};
    bricks += level.bricks;
  }
  for_each(ex, "octree.complete", bricks, fill);
}

}  // namespace pointskin::octree
