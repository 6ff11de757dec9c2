#include "octree/frame.hpp"

#include <pointskin/error.hpp>

#include <algorithm>

namespace pointskin::octree {

Frame frame_around(const Bounds& box, double scale) {
  const Vec3d lower{box.lower.x, box.lower.y, box.lower.z};
  const Vec3d upper{box.upper.x, box.upper.y, box.upper.z};
  Frame result;
  result.size = scale * std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  if (!(result.size > 0))
    throw Error(ErrorCode::empty_result, "all points are at one place; there is no surface to reconstruct");
  for (std::size_t a = 0; a < 3; ++a) result.lower[a] = 0.5 * (lower[a] + upper[a]) - 0.5 * result.size;
  return result;
}

}  // namespace pointskin::octree
