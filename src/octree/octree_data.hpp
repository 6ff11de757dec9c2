// The octree's arrays and how they are built.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/view.hpp"

#include <pointskin/vector.hpp>

namespace pointskin::octree {

/// Arrays of one level; shapes as in LevelView.
struct LevelData {
  std::int32_t cell_bricks = 0;
  std::int32_t bricks = 0;
  std::int32_t near_ghosts = 0;
  exec::Buffer<std::uint64_t> brick_key;
  exec::Buffer<std::int32_t> parent;
  exec::Buffer<std::int32_t> neighbours;
  exec::Buffer<std::int32_t> child_brick;
  exec::Buffer<std::uint8_t> unknowns;
  exec::Buffer<std::int32_t> point_begin;
};

/// Owns the octree in the space it was built in.
struct OctreeData {
  int depth = 0;
  std::vector<LevelData> levels;  ///< depth + 1 of them

  [[nodiscard]] OctreeView view() const;
  [[nodiscard]] std::int64_t nodes() const;
  [[nodiscard]] std::int64_t cells() const;
};

/// Points of the unit cube in the order of their keys.
struct SortedPoints {
  exec::Buffer<std::uint64_t> keys;  ///< (n) point_key, ascending
  exec::Buffer<std::int32_t> order;  ///< (n) index in the caller's order
};

/// Work with points that are sorted, but for a GPU perhaps not yet: then it is done again.
using UseOfSorted = std::function<void(const SortedPoints&)>;

/// Sorts points by key; points with equal keys by a hash of `tie_break` (any function of all their data), so that the
/// result does not depend on the caller's order unless two points are the same in every bit.
/// @param positions  shape (n), in the unit cube
/// @param tie_break  shape (n); equal only for points that may be exchanged
/// @param use        what needs the points in their order, launched as soon as it may be
/// O(n), 24 n bytes of scratch; one more sort where more than 32 points share the upper 48 bits of a key (in clouds of up to
/// 2^20 points also the upper 40), two more again where that many share a key. Deterministic, the same order on every device. @throws Error over_limit if memory
/// runs out
template <exec::Space Exec>
SortedPoints sort_points(
    Exec& ex, ArrayView<const Vec3f> positions, ArrayView<const std::uint64_t> tie_break,
    const UseOfSorted& use = [](const SortedPoints&) {});

/// Builds the padded, graded octree of `point_keys` (P1, P2, P3).
///
/// Level D holds all bricks touched by the 27-neighbourhoods of occupied cells; level d < D those touched by the
/// 27-neighbourhoods of cells that have children; levels 0..kCompleteDepth are complete. Adjacent leaves therefore
/// differ by one level at most, and every corner of every cell has its owner.
/// @param point_keys  shape (n), ascending, n >= 0
/// @param depth       D in [1, kMaxDepth]
/// @throws Error over_limit if a level would need more than 2^31 / 8 bricks, or memory runs out
/// O(n + nodes log nodes); two host round trips for all levels that have bitmaps (brick_sets.hpp), two for every level
/// that has none. Integers only: the same on every device.
template <exec::Space Exec>
OctreeData build_octree(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth);

/// The octree of a cloud of which only some points are there: its levels up to K have the given bricks, finer ones those around
/// `point_keys`. Bricks whose points are there, with those around them, are as in the octree of all points, and so are their
/// neighbours. Levels up to K have the same numbers in every octree that is made here from the same bricks.
/// @param bricks  (K + 1), kCompleteDepth <= K <= depth: the sorted keys of the cell bricks of every level, as build_octree()
///                finds them for the whole cloud; those of the complete levels are not read
/// @param finest  K < finest <= depth, or K = finest = depth: finer levels are empty, as if their cells were none; its own bricks are
///                those around its points' cells, which in a deeper octree it may have more of
/// @throws Error over_limit as build_octree()
/// As build_octree(); two host round trips for every level.
template <exec::Space Exec>
OctreeData build_octree_below(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth,
                              std::span<const ArrayView<const std::uint64_t>> bricks, int finest);

/// Sorted keys of the cell bricks of levels last + 1..depth that these points need, by level; those of several parts of a cloud are,
/// together, those of the cloud.
/// @param point_keys  shape (n), ascending
/// O(n); two or three host round trips
template <exec::Space Exec>
std::vector<exec::Buffer<std::uint64_t>> bricks_of_points(Exec& ex, ArrayView<const std::uint64_t> point_keys,
                                                          int depth, int last);

}  // namespace pointskin::octree
