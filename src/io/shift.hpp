// Which offset to subtract from coordinates before they become float.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin::io {

/// Bounding box in double; as it begins, it holds nothing.
struct Box {
  Vec3d lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
  Vec3d upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};

  void add(const Vec3d& low, const Vec3d& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], low[axis]);
      upper[axis] = std::max(upper[axis], high[axis]);
    }
  }
  [[nodiscard]] double longest_side() const {
    return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }
  /// Of all coordinates.
  [[nodiscard]] double largest_magnitude() const;
};

/// Rows of a table that share a box.
inline constexpr std::int64_t kRunRows = 64;

/// The "auto" rule of ReadOptions::shift, for coordinates that are not float. A few strays, however far, do not decide.
/// @param runs    box of the points of every kRunRows rows
/// @param points  number of all points, at least 1
/// @param beyond  returns all points that are outside of a box, in any order; seldom called, and once at most
/// Independent of the order of the points.
Vec3d automatic_shift(const std::vector<Box>& runs, std::int64_t points,
                      const std::function<std::vector<Vec3d>(const Box&)>& beyond);

}  // namespace pointskin::io
