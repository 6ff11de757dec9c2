// What a set operation does with every point: kept, turned round or dropped.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/cloud.hpp>

namespace pointskin::studio {

enum PointClass : std::uint8_t { kKept = 0, kFlipped = 1, kDropped = 2 };

struct ClassedPoints {
  Cloud points;                         ///< of all parts, with normals as they are before
  std::vector<std::uint8_t> classes{};  ///< PointClass of each
};

/// Finds the points of `parts` in `kept`, where those that are kept stand in the order that they had, the parts one
/// after the other, moved by less than a rounding of float.
/// O(n). Deterministic.
ClassedPoints classes_of_points(const std::vector<const Cloud*>& parts, const Cloud& kept);

}  // namespace pointskin::studio
