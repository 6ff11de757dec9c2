// A look at the samples of a cloud before they count: which are outliers, and how noisy the others are.
#pragma once

#include <cstdint>

#include "exec/space.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// Samples that are looked at to know the whole cloud, evenly spread over the order of the keys.
inline constexpr std::int64_t kLookedAt = 4096;

/// Sets the areas of outliers to 0 (outliers.hpp) and gives the other samples those on their own side; adds to their splat
/// depths what noise and bends ask for, and sets `samples.trust` to what they urge it by (noise.hpp); counts the lonely samples in `samples.lonely`. The usual area
/// is the harmonic mean over the samples that are looked at: the mean density is that of the dense parts, where there are
/// any. A sample with an unusual area that is confirmed has few neighbours to tell sides by: it keeps the larger of its
/// area and the largest usual one.
/// @param depth     of the octree
/// @param coarsest  depth below which splat depths do not fall
/// @param own_side  shape (n), areas on the own side (own_side.hpp), finest cells^2; negative for a sample that disagrees
///                  with those around it. Its buffer becomes that of the splat depths
/// @param bends     shape (n), from the levels (bend.hpp)
/// @param samples   positions, unit normals, areas > 0 and splat depths in key order
/// O(n), deterministic, the same bits on every device. On a GPU six launches and 4 n bytes of scratch; does not wait.
template <exec::Space Exec>
void examine_samples(Exec& ex, int depth, int coarsest, exec::Buffer<float> own_side, exec::Buffer<float> bends,
                     Samples& samples);

}  // namespace pointskin::poisson
