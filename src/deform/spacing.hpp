// How far apart samples are: the mean distance to the 6 nearest neighbours.
#pragma once

#include <pointskin/deform.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/space.hpp"

namespace pointskin::deform {

/// Mean distance of each point to its 6 nearest neighbours, in the order of the points; 0 where there are no others.
/// Independent of their order. A tree and a search of its own; 56 bytes of scratch for each of up to 2^20 points.
template <exec::Space Exec>
std::vector<float> neighbour_distances(Exec& ex, ArrayView<const Vec3f> positions);

/// Percentiles of the distances now over those of the parents at rest; coinciding points are left out.
SpacingRatios spacing_ratios(const std::vector<float>& now, const std::vector<float>& at_rest,
                             const std::vector<std::int32_t>& parents);

}  // namespace pointskin::deform
