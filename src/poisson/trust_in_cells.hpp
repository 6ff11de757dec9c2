// Trust in the samples of a cell.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "octree/view.hpp"
#include "poisson/samples.hpp"
#include "poisson/trust.hpp"

namespace pointskin::poisson {

/// Half the sum of the squared scatter of pairs, and their number. It is summed in kLanes parts, pair i of a cell to
/// part i mod kLanes, so that as many threads may share a cell (trust_kernel.cuh) and have the same bits.
struct Scatter {
  float sum = 0, pairs = 0;

  PSK_HD void add(const Scatter& other) {
    sum += other.sum;
    pairs += other.pairs;
  }
};

inline constexpr int kLanes = 32;

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
    const Vec3f step = scale * (samples.positions[i] - samples.positions[i + 1]);
    const float across = 0.5F * dot(n + m, step);
    const float along2 = squared_length(step) - across * across;
    const bool counts = dot(n, m) > kPairAgreement && along2 < kPairReach * kPairReach;
    return {counts ? 0.5F * (across * across) : 0, counts ? 1.0F : 0.0F};
  }

  /// @param scatter  of all pairs in the cell
  [[nodiscard]] PSK_HD float trust_in(std::int32_t sample, const Scatter& scatter) const {
    constexpr float kPriorVariance = kTrustScale - kCleanVariance;  // where trust is 1
    const float finer = samples.splat_depths[sample] - static_cast<float>(depth);
    const float squared_cells = finer > 0 ? 1 + 3 * finer : 1.0F;
    const float variance = (kPriorPairs * kPriorVariance + squared_cells * scatter.sum) / (kPriorPairs + scatter.pairs);
    const float value = kTrustScale / (kCleanVariance + variance);
    const float urged = trust[sample] * value;
    const float most = value > kMostUrged ? value : kMostUrged;
    const float kept = urged < most ? urged : most;
    return kept > kSmallestTrust ? kept : kSmallestTrust;
  }
};

}  // namespace pointskin::poisson
