// How far apart the numbers lie that a cloud's coordinates were taken from.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <functional>
#include <vector>

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

/// The same for points that come in parts.
/// @param are_floats  are_floats(axis): whether all world coordinates along an axis are numbers of float; asked where there is an
///                    origin and steps are large enough
double coordinate_step(const Vec3d& origin, const octree::Frame& frame, double at_least,
                       const std::function<bool(std::size_t)>& are_floats);

[[nodiscard]] inline bool is_float(double world) { return static_cast<double>(static_cast<float>(world)) == world; }

/// Says that coordinates have too few digits for their spacing, or lost some to the origin.
/// @param given  coordinate_step()
void warn_of_coordinates(const Vec3d& origin, const octree::Frame& frame, double given, double spacing,
                         std::vector<Warning>& warnings);

}  // namespace pointskin::detail
