// Boxes in double, where differences of floats cannot overflow, and the middle of a cloud that a few strays do not
// widen.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin {

/// As it begins, it holds nothing.
struct Box {
  Vec3d lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
  Vec3d upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};

  /// Widens the box to hold that from `low` to `high`.
  void add(const Vec3d& low, const Vec3d& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], low[axis]);
      upper[axis] = std::max(upper[axis], high[axis]);
    }
  }
  [[nodiscard]] double longest_side() const {
    return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }
};

/// The `rank`-th smallest value, counted from 0; `otherwise` if there are not so many. O(n).
inline double smallest(std::vector<double> values, std::int64_t rank, double otherwise) {
  if (static_cast<std::int64_t>(values.size()) <= rank) return otherwise;
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

/// Along every axis, from the `rank`-th smallest to the `rank`-th largest coordinate of all points, counted from 0, but
/// not beyond `ends`. O(n), independent of the order.
/// @param outside  all points beyond `ends`, maybe with others
/// @param at       position of one of them, a Vec3d
template <class Points, class At>
Box middle_of(const Points& outside, const At& at, const Box& ends, std::int64_t rank) {
  Box middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> below;
    std::vector<double> above;  // with the sign turned, so that the largest is the smallest
    for (const auto& point : outside) {
      const double x = at(point)[axis];
      if (x < ends.lower[axis]) below.push_back(x);
      if (x > ends.upper[axis]) above.push_back(-x);
    }
    middle.lower[axis] = smallest(std::move(below), rank, ends.lower[axis]);
    middle.upper[axis] = -smallest(std::move(above), rank, -ends.upper[axis]);
  }
  return middle;
}

}  // namespace pointskin
