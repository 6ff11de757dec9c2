// How far the position of a sample is trusted: its weight in the screening, from how much the samples around it scatter
// across the surface. Clean samples hold the surface where they are; noisy ones leave it to the smoothness of the
// field.
#pragma once

#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// Scatter is measured on pairs of samples that follow each other in Morton order, if their normals agree this well
/// (cosine) and the distance between them along the surface is below kPairReach, in cells of their splat depth.
inline constexpr float kPairAgreement = 0.9F;
inline constexpr float kPairReach = 1.4142135F;

/// Trust = kTrustScale / (kCleanVariance + variance), the variance in squared cells of the splat depth: 6.5 for clean
/// samples, 1 at a standard deviation of 0.15 cells (docs/decisions/0017-noise-and-smoothness.md).
inline constexpr float kTrustScale = 0.0262F;
inline constexpr float kCleanVariance = 0.004F;
inline constexpr float kSmallestTrust = 0.05F;

/// Trust is multiplied by the urge of noise.hpp, but where that is above 1 not beyond this.
inline constexpr float kMostUrged = 2;

/// Pairs with the variance of trust 1 that are counted in: where there are few pairs, samples weigh as they are.
inline constexpr float kPriorPairs = 1;

/// Trust on a level: a scatter of so many cells is a fraction of that in the larger cells of a coarser one. So what is
/// too noisy to hold the surface where it is may still hold it within a coarser cell. At most 1 where it was less.
/// @param trust  at the splat depth, > 0
PSK_HD inline float trust_at(float trust, float splat_depth, int depth) {
  const int finer = finer_level(splat_depth);
  if (trust >= 1 || depth >= finer) return trust;
  const float squared_cells = (1 + 3 * (static_cast<float>(finer) - splat_depth)) /
                              static_cast<float>(std::int64_t{1} << 2 * (finer - depth));  // 4^(depth - splat_depth)
  const float variance = kTrustScale / trust - kCleanVariance;
  const float there = kTrustScale / (kCleanVariance + (squared_cells < 1 ? squared_cells : 1.0F) * variance);
  return there < 1 ? there : 1.0F;
}

/// Fills `samples.trust`, which holds the urges of examine.hpp before; empty: 1 everywhere. The variance is pooled over the
/// cell of level D - 2 around a sample, for samples splatted one
/// or more levels above the finest over that of level D - 3 or D - 4.
/// Half the mean over the pairs (p, n), (q, m) of ((n + m) / 2 . (p - q))^2; the mean normal of two points of a curve
/// that bends evenly is perpendicular to the line between them, so that curvature does not count as scatter.
/// @param samples  positions, unit normals and splat depths in key order
/// O(n), deterministic, the same bits on every device.
template <exec::Space Exec>
void weigh_trust(Exec& ex, const octree::OctreeData& tree, Samples& samples);

}  // namespace pointskin::poisson
