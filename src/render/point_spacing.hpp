// How far apart the points of a cloud are, for the size that they are drawn in.
#pragma once

#include <pointskin/vector.hpp>

#include <vector>

#include "exec/cpu.hpp"

namespace pointskin::render_detail {

/// About the side of the square of surface (or the cube of volume) that a point has for itself, world units; points at
/// one place count once. 0 if there is but one place. Points that are not finite do not count. O(n log n), 16 n bytes.
/// Independent of the order of the points.
double point_spacing(exec::Cpu& ex, const std::vector<Vec3f>& positions, const Vec3d& centre, double radius);

}  // namespace pointskin::render_detail
