#pragma once

#include <algorithm>

#include "exec/algorithms.hpp"
#include "poisson/trust.hpp"

namespace pointskin::poisson {
namespace trust {

/// Half the sum of the squared scatter of pairs, and their number. It is summed in kLanes parts, pair i of a cell to
/// part i mod kLanes, so that as many threads may share a cell (trust_kernel.cuh) and have the same bits.
struct Scatter {
  float sum = 0, pairs = 0;

  PSK_HD void add(const Scatter& other) {
    sum += other.sum;
    pairs += other.pairs;
  }
};
inline constexpr int kLanes = 8;

/// Trust in the samples of the cells of `level` that are splatted at `depth` and above it, below `depth` + 1; at the
/// last depth also in all sparser ones.
struct TrustInCells {
  octree::LevelView level;
  int depth;
  bool last;
  SamplesView samples;
  ArrayView<float> trust;

  [[nodiscard]] PSK_HD bool is_meant(std::int32_t sample) const {
    const auto splat_depth = static_cast<int>(samples.splat_depths[sample]);
    return splat_depth == depth || (last && splat_depth < depth);
  }

  /// Of the pair of a sample and the next one, in squared cells of `depth`.
  [[nodiscard]] PSK_HD Scatter scatter_of(std::int32_t i) const {
    const auto scale = static_cast<float>(std::int64_t{1} << depth);
    const Vec3f n = samples.normals[i];
    const Vec3f m = samples.normals[i + 1];
    const Vec3f p = samples.positions[i];
    const Vec3f q = samples.positions[i + 1];
    const Vec3f step{scale * (p.x - q.x), scale * (p.y - q.y), scale * (p.z - q.z)};
    const float across = 0.5F * ((n.x + m.x) * step.x + (n.y + m.y) * step.y + (n.z + m.z) * step.z);
    const float along2 = (step.x * step.x + step.y * step.y + step.z * step.z) - across * across;
    const bool counts = n.x * m.x + n.y * m.y + n.z * m.z > kPairAgreement && along2 < kPairReach * kPairReach;
    return {counts ? 0.5F * (across * across) : 0, counts ? 1.0F : 0.0F};
  }

  /// @param scatter  of all pairs in the cell
  [[nodiscard]] PSK_HD float trust_in(std::int32_t sample, const Scatter& scatter) const {
    constexpr float kPriorVariance = kTrustScale - kCleanVariance;  // where trust is 1
    const float finer = samples.splat_depths[sample] - static_cast<float>(depth);
    const float squared_cells = finer > 0 ? 1 + 3 * finer : 1.0F;
    const float variance = (kPriorPairs * kPriorVariance + squared_cells * scatter.sum) / (kPriorPairs + scatter.pairs);
    const float value = kTrustScale / (kCleanVariance + variance);
    return value > kSmallestTrust ? value : kSmallestTrust;
  }
};

/// A cell at a time. A GPU has a kernel of its own for it (trust_kernel.cuh).
struct TrustInCell : TrustInCells {
  PSK_HD void operator()(std::int64_t cell) const {
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t end = level.point_begin[cell + 1];
    std::int32_t at = first;
    while (at < end && !is_meant(at)) ++at;
    if (at == end) return;
    const Scatter scatter = scatter_in(first, end);
    for (; at < end; ++at)
      if (is_meant(at)) trust[at] = trust_in(at, scatter);
  }

  [[nodiscard]] PSK_HD Scatter scatter_in(std::int32_t first, std::int32_t end) const {
    Scatter part[kLanes];
    for (std::int32_t i = first; i + 1 < end; ++i) part[(i - first) % kLanes].add(scatter_of(i));
    for (int step = kLanes / 2; step > 0; step /= 2)
      for (int lane = 0; lane < step; ++lane) part[lane].add(part[lane + step]);
    return part[0];
  }
};

template <exec::Space Exec>
void find_trust(Exec& ex, const TrustInCells& cells) {
  for_each(ex, "screening.trust", cells.level.cells(), TrustInCell{cells});
}

}  // namespace trust

template <exec::Space Exec>
void weigh_trust(Exec& ex, const octree::OctreeData& tree, Samples& samples) {
  constexpr int kLevelsAbove = 2;  // the cells over which samples are pooled hold 16 of their own on a surface
  constexpr int kDepths = 3;       // sparser samples take the finest of these: a thread should not have too many
  const octree::OctreeView view = tree.view();
  samples.trust = exec::make_buffer<float>(ex, samples.positions.size());
  for (int i = 0; i < kDepths && i <= view.depth; ++i) {
    const int depth = view.depth - i;
    const bool last = i == std::min(kDepths - 1, view.depth);
    const std::uint32_t depths = last ? (2U << depth) - 1 : 1U << depth;
    if ((samples.splat_depth_set & depths) == 0) continue;
    const octree::LevelView& level = view.levels[std::max(0, depth - kLevelsAbove)];
    find_trust(ex, trust::TrustInCells{level, depth, last, samples.view(), samples.trust.view()});
  }
}

}  // namespace pointskin::poisson
