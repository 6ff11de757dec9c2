// How large trial fields are.
#pragma once

#include <cstdint>

#include "octree/even_depth.hpp"

namespace pointskin::normals {

/// Working cube / bounding cube: the trial field is 0 on the cube, which must not be near.
inline constexpr double kTrialRoom = 1.5;

/// With twice as many samples a cell, the smoothed normals of sheets two spacings apart overlap, and speak for equal
/// sides.
inline int trial_depth(std::int64_t n) { return octree::depth_of_even_samples(n); }

}  // namespace pointskin::normals
