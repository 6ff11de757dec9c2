// How far apart the numbers lie that a cloud's coordinates were taken from.
#pragma once

#include "octree/frame.hpp"
#include "reconstruct/input.hpp"

namespace pointskin::detail {

/// Where all world coordinates along an axis are numbers of float, the distance of two such numbers at the farthest
/// coordinate; of the three axes the largest. 0 if it is below `at_least`, or if some coordinates have more digits.
/// Points that lie where the space works and have an origin are taken to have more.
/// @param frame     the cube of the points
/// @param at_least  world units, >= 0; nothing is read where steps are smaller
/// O(1) where coordinates are near enough, else O(n) for those on the host.
double coordinate_step(const Input& input, const octree::Frame& frame, double at_least);

}  // namespace pointskin::detail
