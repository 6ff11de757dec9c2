// Outliers: samples far from all others that no neighbour confirms, and clusters of samples that face all ways. What a
// sample adds to the field is in proportion to the area it stands for, and far from all others that is a large one: an
// outlier would act like hundreds of samples of the surface, and blow a bubble. So may a sample of a part that was seen
// sparsely; there the neighbours confirm it.
#pragma once

#include <cstdint>

#include "exec/space.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// A sample that stands for more than so many times the usual area needs neighbours that confirm it.
inline constexpr float kUnusualArea = 4;

/// Neighbours are the samples up to kWindow places before and after in key order that are nearer than kNearCells cells
/// of the splat depth.
inline constexpr std::int64_t kWindow = 8;
inline constexpr float kNearCells = 3;

/// A neighbour confirms a sample if the two could lie on one surface: the cosine between the normals is above
/// kLeastCosine, and the squared cosine between the mean normal and the line from one to the other at most kMostBend.
inline constexpr float kLeastCosine = 0.3F;
inline constexpr float kMostBend = 0.0625F;

/// Below this cosine a neighbour is on the other side of a thin wall, and says nothing.
inline constexpr float kOtherSideCosine = -0.8F;

/// So many neighbours must confirm a sample, and this share of all: of random normals, one in ten does
/// (docs/decisions/0041-rough-data.md).
inline constexpr int kFewestConfirming = 2;
inline constexpr float kLeastConfirming = 0.34F;

/// Samples with so many times the largest usual area are lonely, confirmed or not: a cloud that has some has outliers, or
/// ends so thinly that pieces of its surface may hang on one sample.
inline constexpr float kLonely = 8;

/// A sample among at least kManyNeighbours is in a cluster of outliers if fewer than kFewestAlike of them have a normal
/// with a cosine above kAlikeCosine: in any direction, of random normals one in ten has; along an edge every second,
/// at a corner every third. That is only asked of clouds of which the share kMostlyAlike of kLookedAt samples, evenly
/// spread, passes: the normals of others are too noisy, or the surface bends too fast, to tell.
inline constexpr int kManyNeighbours = 12;
inline constexpr int kFewestAlike = 3;
inline constexpr float kAlikeCosine = 0.8F;
inline constexpr double kMostlyAlike = 0.75;
inline constexpr std::int64_t kLookedAt = 8192;

/// Sets the areas of outliers to 0, counts the lonely ones in `samples.lonely`, and gives the others those on their own side. The usual area is the harmonic mean of
/// these: the mean density is that of the dense parts, where there are any. A sample with an unusual area that is
/// confirmed has few neighbours to tell sides by: it keeps the larger of its area and the largest usual one.
/// @param own_side  shape (n), areas on the own side (own_side.hpp), finest cells^2
/// @param samples   positions, unit normals, areas > 0 and splat depths in key order
/// O(n), deterministic, the same bits on every device. Six launches; does not wait.
template <exec::Space Exec>
void drop_outliers(Exec& ex, ArrayView<const float> own_side, Samples& samples);

}  // namespace pointskin::poisson
