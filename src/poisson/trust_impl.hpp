#pragma once

#include <algorithm>

#include "exec/algorithms.hpp"
#include "poisson/trust.hpp"

namespace pointskin::poisson {
namespace trust {

/// The samples of one cell of `level` that are splatted at `depth`, at the last depth also those above.
struct TrustInCell {
  struct Scatter {
    float sum = 0, pairs = 0;
  };

  octree::LevelView level;
  int depth;
  bool last;
  SamplesView samples;
  ArrayView<float> trust;

  PSK_HD void operator()(std::int64_t cell) const {
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t end = level.point_begin[cell + 1];
    std::int32_t at = first;
    while (at < end && !is_meant(at)) ++at;
    if (at == end) return;
    const Scatter scatter = scatter_of(first, end);
    for (; at < end; ++at)
      if (is_meant(at)) trust[at] = trust_in(scatter, samples.splat_depths[at]);
  }

  [[nodiscard]] PSK_HD bool is_meant(std::int32_t sample) const {
    const auto splat_depth = static_cast<int>(samples.splat_depths[sample]);
    return splat_depth == depth || (last && splat_depth < depth);
  }

  [[nodiscard]] PSK_HD float trust_in(const Scatter& s, float splat_depth) const {
    constexpr float kPriorVariance = kTrustScale - kCleanVariance;  // where trust is 1
    const float finer = splat_depth - static_cast<float>(depth);
    const float squared_cells = finer > 0 ? 1 + 3 * finer : 1.0F;
    const float variance = (kPriorPairs * kPriorVariance + 0.5F * squared_cells * s.sum) / (s.pairs + kPriorPairs);
    const float value = kTrustScale / (kCleanVariance + variance);
    return value > kSmallestTrust ? value : kSmallestTrust;
  }

  [[nodiscard]] PSK_HD Scatter scatter_of(std::int32_t first, std::int32_t end) const {
    const auto scale = static_cast<float>(std::int64_t{1} << depth);
    float sum = 0;
    float pairs = 0;
    PSK_UNROLL_BY_4 for (std::int32_t i = first; i + 1 < end; ++i) {
      const Vec3f n = samples.normals[i];
      const Vec3f m = samples.normals[i + 1];
      const Vec3f p = samples.positions[i];
      const Vec3f q = samples.positions[i + 1];
      const Vec3f step{scale * (p.x - q.x), scale * (p.y - q.y), scale * (p.z - q.z)};
      const float across = 0.5F * ((n.x + m.x) * step.x + (n.y + m.y) * step.y + (n.z + m.z) * step.z);
      const float along2 = (step.x * step.x + step.y * step.y + step.z * step.z) - across * across;
      const bool counts = n.x * m.x + n.y * m.y + n.z * m.z > kPairAgreement && along2 < kPairReach * kPairReach;
      sum += counts ? across * across : 0;
      pairs += counts ? 1.0F : 0.0F;
    }
    return {sum, pairs};
  }
};

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
    for_each(ex, "screening.trust", level.cells(),
             trust::TrustInCell{level, depth, last, samples.view(), samples.trust.view()});
  }
}

}  // namespace pointskin::poisson
