// How noisy the samples are, against the distance between them, and so how coarse a level has to carry their normals.
// Clean samples say where the surface is by themselves: averaged over as many as noisy ones need, sparse clouds lose
// their shape. Where noise is half as wide as the distance between samples, it takes more of them.
#pragma once

#include <cstdint>

#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// Samples that are looked at, evenly spread over the order of the keys, each with those that follow it.
inline constexpr std::int64_t kNoiseSamples = 8192;

/// Noise is the standard deviation of a sample across the surface over the distance between samples. Up to kClean the
/// splat depths are kFiner levels finer, so that a third of the samples carries a normal; from kSomeNoise to kMuchNoise
/// they stay; from kTooMuchNoise on they are kCoarser levels coarser, with twice the samples. In between linear.
inline constexpr float kClean = 0.03F, kSomeNoise = 0.12F, kMuchNoise = 0.4F, kTooMuchNoise = 0.6F;
inline constexpr float kFiner = 0.79F, kCoarser = 0.5F;

/// On scan lines the fourth sample after one is often more than sqrt(kAlongLines) = 3.5 times as far away as the next:
/// for half of the samples, but for one in three where they are spread over the surface. Density then says nothing of
/// the distance between lines, and the depths do not get finer. Shares in between: linear.
inline constexpr float kAlongLines = 12;
inline constexpr float kNoLines = 0.38F, kLines = 0.46F;

/// Depths get finer only where the shape asks for it, along bends and across edges: for samples with a normal more than
/// 10 degrees apart among those up to kFollowers places before and after and nearer than kNear distances between samples.
inline constexpr float kBentCosine = 0.985F;
inline constexpr std::int64_t kFollowers = 4;
inline constexpr float kNear = 2;

/// Adds to the splat depths what the noise of the whole cloud asks for. Over the pairs (p, n), (q, m) of a sample and
/// the next one, if the normals agree and the two are near each other along the surface,
///   noise^2 = median of ((n + m) / 2 . (p - q))^2 / (2 area_p) / 0.674^2,   area_p = 1 / density, 0.674^2 of a Gaussian;
/// an evenly bent surface adds nothing to it (trust.hpp), and sharp edges are too few to move a median.
/// @param coarsest  depth below which splat depths do not fall
/// @param samples   positions, unit normals and splat depths in key order
/// O(n), deterministic, the same bits on every device. Three launches; does not wait.
template <exec::Space Exec>
void adapt_to_noise(Exec& ex, const octree::OctreeData& tree, const Density& density, int coarsest, Samples& samples);

}  // namespace pointskin::poisson
