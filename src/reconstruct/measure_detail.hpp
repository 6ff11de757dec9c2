// How much detail the points of a cloud hold: their spacing and their noise.
#pragma once

#include <pointskin/reconstruct.hpp>

#include "exec/space.hpp"
#include "reconstruct/input.hpp"

namespace pointskin::detail {

/// How much detail points hold, in world units.
struct Detail {
  double cube = 0;     ///< side of the working cube
  double spacing = 0;  ///< between samples of the surface, median: the side of the square that holds one
  double noise = 0;    ///< standard deviation of samples across the surface (diagnose/sheets.hpp)
};

/// By an octree with about 1.5 points a cell, or more where Options::max_memory_bytes holds no finer one.
/// @throws Error as upload_some and frame_around; over_limit
/// O(n log n), most of it the sort and the octree. Deterministic.
template <exec::Space Exec>
Detail measure_detail(Exec& ex, const Input& input, const Options& options);

}  // namespace pointskin::detail
