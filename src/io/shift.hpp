// Which offset to subtract from coordinates before they become float.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <pointskin/vector.hpp>

#include "core/box.hpp"

namespace pointskin::io {

/// Rows of a table that share a box.
inline constexpr std::int64_t kRunRows = 64;

/// The "auto" rule of ReadOptions::shift. A few strays, however far, do not decide.
/// @param runs        box of the points of every kRunRows rows
/// @param points      number of all points, at least 1
/// @param resolution  steps of the coordinates that float must not blur, world units; 0: unknown
/// @param has_digits  the coordinates have more digits than float; those of one place that have not are left as they are
/// @param beyond      returns all points that are outside of a box, in any order; seldom called, and once at most
/// Independent of the order of the points.
Vec3d automatic_shift(const std::vector<Box>& runs, std::int64_t points, double resolution, bool has_digits,
                      const std::function<std::vector<Vec3d>(const Box&)>& beyond);

}  // namespace pointskin::io
