#include <pointskin/cloud.hpp>

#include <algorithm>

namespace pointskin {

Bounds bounds_of(const std::vector<Vec3f>& positions) {
  if (positions.empty()) return {};
  Bounds bounds{positions.front(), positions.front()};
  for (const Vec3f& p : positions) {
    bounds.lower = {std::min(bounds.lower.x, p.x), std::min(bounds.lower.y, p.y), std::min(bounds.lower.z, p.z)};
    bounds.upper = {std::max(bounds.upper.x, p.x), std::max(bounds.upper.y, p.y), std::max(bounds.upper.z, p.z)};
  }
  return bounds;
}

}  // namespace pointskin
