// Outward normals for a cloud: what a NormalEstimator asks of a space.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/normals.hpp>

#include "exec/space.hpp"
#include "normals/evidence.hpp"

namespace pointskin::normals {

/// As NormalEstimator::orient.
/// @param options  valid, with the method that is to be used
/// @param report   receives all but method and total_ms
template <exec::Space Exec>
void orient(Exec& ex, Cloud& cloud, const Views& views, const NormalOptions& options, NormalReport& report);

}  // namespace pointskin::normals
