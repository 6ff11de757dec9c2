#include "reconstruct/coordinate_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pointskin::detail {
namespace {

constexpr int kFractionBits = 23;

bool are_floats(const Input& input, std::size_t axis) {
  const double origin = input.origin()[axis];
  if (origin == 0) return true;
  if (input.cloud() == nullptr) return false;
  const auto is_float = [&](const Vec3f& p) {
    const double world = origin + static_cast<double>(axis == 0 ? p.x : axis == 1 ? p.y : p.z);
    return static_cast<double>(static_cast<float>(world)) == world;
  };
  const auto& positions = input.cloud()->positions;
  return std::all_of(positions.begin(), positions.end(), is_float);
}

}  // namespace

double coordinate_step(const Input& input, const octree::Frame& frame, double at_least) {
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lower = input.origin()[axis] + frame.lower[axis];
    const double reach = std::max(std::abs(lower), std::abs(lower + frame.size));
    const double step = std::ldexp(1.0, std::ilogb(reach) - kFractionBits);
    if (step > largest && step >= at_least && are_floats(input, axis)) largest = step;
  }
  return largest;
}

}  // namespace pointskin::detail
