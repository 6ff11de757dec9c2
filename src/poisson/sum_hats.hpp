// Sums of hats over the samples, at the corners of a level and of all above it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "exec/algorithms.hpp"
#include "exec/space.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "octree/placed.hpp"

namespace pointskin::poisson {

namespace hats {

/// A cell's samples at its 8 corners: hats of a level are sums of finer hats, so no finer level is needed.
/// @tparam What  what(i) is what sample i adds, a What::Value
template <class What>
struct SumInCell {
  octree::LevelView level;
  ArrayView<const Vec3f> positions;
  What what;
  ArrayView<typename What::Value> sums;  // (8 cells) at the corners of each cell
  PSK_HD void operator()(std::int64_t cell) const {
    typename What::Value sum[8] = {};
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t last = level.point_begin[cell + 1];
    if (first < last) {
      const octree::Coordinates at = octree::decode(level.node_key(static_cast<std::int32_t>(cell)));
      PSK_UNROLL_BY_4 for (std::int32_t i = first; i < last; ++i) {
        const Vec3f local = octree::local_in_cell(positions[i], at, level.depth);
        const typename What::Value value = what(i);
        PSK_UNROLL
        for (int s = 0; s < 8; ++s) sum[s] += octree::corner_weight(s, local) * value;
      }
    }
    for (int s = 0; s < 8; ++s) sums[8 * cell + s] = sum[s];
  }
};

/// The same with a thread for every corner of a cell, for spaces with many. Of a full cell, it fetches several samples before it
/// uses one.
template <class What>
struct SumAtCorner {
  static constexpr int kAtOnce = 8;

  SumInCell<What> in_cell;
  PSK_HD void operator()(std::int64_t corner) const {
    const std::int64_t cell = corner >> 3;
    const std::int32_t first = in_cell.level.point_begin[cell];
    const std::int32_t last = in_cell.level.point_begin[cell + 1];
    const octree::Coordinates at = octree::decode(in_cell.level.node_key(static_cast<std::int32_t>(cell)));
    typename What::Value sum{};
    const std::int32_t count = last - first;
    for (std::int32_t done = 0; done < count; done += kAtOnce) {
      Vec3f position[kAtOnce];
      typename What::Value value[kAtOnce];
      PSK_UNROLL
      for (int k = 0; k < kAtOnce; ++k) {
        const std::int32_t i = first + (done + k < count ? done + k : count - 1);
        position[k] = in_cell.positions[i];
        value[k] = in_cell.what(i);
      }
      PSK_UNROLL
      for (int k = 0; k < kAtOnce; ++k) {
        const Vec3f local = octree::local_in_cell(position[k], at, in_cell.level.depth);
        if (done + k < count) sum += octree::corner_weight(static_cast<int>(corner & 7), local) * value[k];
      }
    }
    in_cell.sums[corner] = sum;
  }
};

/// Sum over the 8 cells around a corner.
template <class T>
struct Gather {
  octree::LevelView level;
  ArrayView<const T> in_cells;
  ArrayView<T> sums;
  PSK_HD void operator()(std::int64_t n) const {
    T sum{};
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const std::int32_t cell =
          level.neighbour(static_cast<std::int32_t>(n), -octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s));
      if (level.is_cell(cell)) sum += in_cells[8 * std::int64_t{cell} + s];
    }
    sums[n] = sum;
  }
};

template <class T>
struct Restrict {
  octree::LevelView level, below;
  const T* below_sums;
  ArrayView<T> sums;
  PSK_HD void operator()(std::int64_t n) const {
    sums[n] = octree::restricted(level, below, below_sums, static_cast<std::int32_t>(n));
  }
};

/// The levels that are complete and small, one a round: each is done in less time than a launch takes.
template <class T>
struct RestrictLevels : exec::SweepAll {
  octree::OctreeView tree;
  int first;  // depth of round 0
  T* sums;

  [[nodiscard]] PSK_HD int indices(int round) const { return static_cast<int>(tree.levels[first - round].nodes()); }
  PSK_HD void operator()(int round, int n, Nothing) const {
    const octree::LevelView& level = tree.levels[first - round];
    const octree::LevelView& below = tree.levels[first - round + 1];
    sums[level.first_node + n] = octree::restricted(level, below, sums + below.first_node, n);
  }
};

/// The last of these: the few threads of a sweep would take longer over the next one than a launch.
inline constexpr int kLastSmallDepth = 4;

}  // namespace hats

/// sum_p phi_c(p) what(p) at the corners c of level `depth` and, since hats are nested, of all levels above.
/// @returns shape (nodes of the levels 0..depth), level-major
/// O(8 n + 27 nodes of these levels), no atomics, deterministic.
template <exec::Space Exec, class What>
exec::Buffer<typename What::Value> sum_hats(Exec& ex, const octree::OctreeView& tree, int depth,
                                            ArrayView<const Vec3f> positions, const What& what) {
  using T = typename What::Value;
  const octree::LevelView& counted = tree.levels[depth];
  exec::Buffer<T> sums;
  {
    const auto placed = octree::placed_on_levels(ex, tree, depth);
    sums = exec::make_buffer<T>(ex, counted.first_node + counted.nodes());
  }
  {
    auto in_cells = exec::make_buffer<T>(ex, 8 * counted.cells());
    const hats::SumInCell<What> sum{counted, positions, what, in_cells.view()};
    if constexpr (Exec::kManyThreads)
      for_each(ex, "density.splat", in_cells.size(), hats::SumAtCorner<What>{sum});
    else
      for_each(ex, "density.splat", counted.cells(), sum);
    const auto placed = octree::placed_on_level(ex, counted);
    for_each(ex, "density.splat", counted.nodes(),
             hats::Gather<T>{counted, in_cells.cview(), sums.view().part(counted.first_node, counted.nodes())});
  }
  const int small = std::min(depth - 1, hats::kLastSmallDepth);
  for (int d = depth - 1; d > small; --d) {
    const octree::LevelView& level = tree.levels[d];
    const octree::LevelView& below = tree.levels[d + 1];
    const auto placed = octree::placed_on_level(ex, level);
    for_each(ex, "density.restrict", level.nodes(),
             hats::Restrict<T>{level, below, sums.data() + below.first_node,
                               sums.view().part(level.first_node, level.nodes())});
  }
  if (small >= 0)
    sweep(ex, "density.restrict", small + 1, tree.levels[small].nodes(),
          hats::RestrictLevels<T>{{}, tree, small, sums.data()});
  return sums;
}

}  // namespace pointskin::poisson
