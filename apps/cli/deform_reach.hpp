// Parts of a deformation that reach no point.
#pragma once

#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/deform.hpp>

namespace pointskin::cli {

/// True if some handle turns, shifts or stretches, or some control point is moved.
bool moves_anything(const Deformation& deformation);

/// Sentences about what reaches none of the points of `rest`: handles without a point in their region, which still bend
/// what is near, and the first lattice, if there are no handles before it, without a point in its block.
/// O(points) a part. @param deformation  valid
std::vector<std::string> idle_parts(const Deformation& deformation, const Cloud& rest);

}  // namespace pointskin::cli
