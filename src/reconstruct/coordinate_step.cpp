#include "reconstruct/coordinate_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "diagnose/warnings.hpp"

namespace pointskin::detail {
namespace {

constexpr int kFractionBits = 23;

bool are_floats(const Input& input, std::size_t axis) {
  if (input.cloud() == nullptr) return false;
  const double origin = input.origin()[axis];
  const auto& positions = input.cloud()->positions;
  return std::all_of(positions.begin(), positions.end(), [&](const Vec3f& p) {
    return is_float(origin + static_cast<double>(axis == 0 ? p.x : axis == 1 ? p.y : p.z));
  });
}

}  // namespace

double coordinate_step(const Vec3d& origin, const octree::Frame& frame, double at_least,
                       const std::function<bool(std::size_t)>& are_floats) {
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lower = origin[axis] + frame.lower[axis];
    const double reach = std::max(std::abs(lower), std::abs(lower + frame.size));
    const double step = std::ldexp(1.0, std::ilogb(reach) - kFractionBits);
    if (step > largest && step >= at_least && (origin[axis] == 0 || are_floats(axis))) largest = step;
  }
  return largest;
}

double coordinate_step(const Input& input, const octree::Frame& frame, double at_least) {
  return coordinate_step(input.origin(), frame, at_least, [&](std::size_t axis) { return are_floats(input, axis); });
}

void warn_of_coordinates(const Vec3d& origin, const octree::Frame& frame, double given, double spacing,
                         std::vector<Warning>& warnings) {
  const double kept = octree::float_step(frame);
  if (kept > given)
    diagnose::warn_of_origin(origin, kept, "points lie", spacing, warnings);
  else
    diagnose::warn_of_digits(given, spacing, warnings);
}

}  // namespace pointskin::detail
