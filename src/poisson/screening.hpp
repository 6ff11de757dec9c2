// Screening: the samples of a cell, collapsed into one, pull the field towards 1/2.
// Source: Kazhdan & Hoppe, "Screened Poisson surface reconstruction", TOG 2013, section 4.
// Differs: one collapsed sample a cell (weighted mean position, total weight), so nothing is stored per matrix entry.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// All samples of a cell as one. Weight 0: the cell is empty.
struct alignas(16) CollapsedSample {
  float x = 0, y = 0, z = 0;  ///< mean position in the cell, in [0, 1]
  float weight = 0;           ///< sum of areas, in finest cells^2, times trust and squared sampled_share
};

/// Collapsed samples of one level, kept for bricks that hold samples.
struct ScreeningView {
  const std::int32_t* brick_index =
      nullptr;                               ///< (bricks) place among the bricks of all levels that hold samples, or -1
  const CollapsedSample* samples = nullptr;  ///< (8 occupied bricks of all levels)
  const std::uint8_t* corners = nullptr;     ///< (bricks) bit s: some cell around corner s holds a sample with weight
};

/// Owns the collapsed samples of all levels.
struct Screening {
  std::vector<std::int64_t> first_brick;  ///< of each level in brick_index
  exec::Buffer<std::int32_t> brick_index;
  exec::Buffer<CollapsedSample> samples;
  exec::Buffer<std::uint8_t> corners;

  [[nodiscard]] ScreeningView view(int depth) const {
    const std::int64_t first = first_brick[static_cast<std::size_t>(depth)];
    return {of_level(brick_index, first), samples.data(), of_level(corners, first)};
  }

 private:
  /// Null where there is nothing.
  template <class T>
  [[nodiscard]] static const T* of_level(const exec::Buffer<T>& all, std::int64_t first) {
    return all.empty() ? nullptr : all.data() + first;
  }
};

/// Collapses the samples of every cell of every level, finest first: from the samples themselves down to the coarsest
/// splat depth, then from the collapsed samples of the children. O(n (D - coarsest splat depth + 1) + bricks).
template <exec::Space Exec>
Screening collapse_samples(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples);

}  // namespace pointskin::poisson
