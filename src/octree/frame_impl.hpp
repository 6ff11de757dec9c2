#pragma once

#include <pointskin/error.hpp>

#include <algorithm>

#include "exec/algorithms.hpp"
#include "octree/frame.hpp"

namespace pointskin::octree {
namespace frame {

struct Box {
  Vec3f lower, upper;
};
struct BoxOf {
  ArrayView<const Vec3f> positions;
  PSK_HD Box operator()(std::int64_t i) const { return {positions[i], positions[i]}; }
};
struct Join {
  PSK_HD static float smaller(float a, float b) { return a < b ? a : b; }
  PSK_HD static float larger(float a, float b) { return a > b ? a : b; }
  PSK_HD Box operator()(const Box& a, const Box& b) const {
    return {{smaller(a.lower.x, b.lower.x), smaller(a.lower.y, b.lower.y), smaller(a.lower.z, b.lower.z)},
            {larger(a.upper.x, b.upper.x), larger(a.upper.y, b.upper.y), larger(a.upper.z, b.upper.z)}};
  }
};

}  // namespace frame

template <exec::Space Exec>
Frame fit_frame(Exec& ex, ArrayView<const Vec3f> positions, double scale) {
  if (positions.empty()) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  const auto box =
      exec::reduce<frame::Box>(ex, "octree.bounds", positions.size, frame::BoxOf{positions}, frame::Join{});
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
