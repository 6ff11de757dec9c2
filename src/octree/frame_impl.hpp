#pragma once

#include <pointskin/error.hpp>

#include "exec/algorithms.hpp"
#include "octree/frame.hpp"

namespace pointskin::octree {
namespace frame {

struct BoxOf {
  ArrayView<const Vec3f> positions;
  PSK_HD Bounds operator()(std::int64_t i) const { return {positions[i], positions[i]}; }
};
struct Join {
  PSK_HD static float smaller(float a, float b) { return a < b ? a : b; }
  PSK_HD static float larger(float a, float b) { return a > b ? a : b; }
  PSK_HD static Vec3f lower_of(const Vec3f& a, const Vec3f& b) {
    return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
  }
  PSK_HD static Vec3f upper_of(const Vec3f& a, const Vec3f& b) {
    return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
  }
  PSK_HD Bounds operator()(const Bounds& a, const Bounds& b) const {
    return {lower_of(a.lower, b.lower), upper_of(a.upper, b.upper)};
  }
};

}  // namespace frame

template <exec::Space Exec>
Bounds box_around(Exec& ex, ArrayView<const Vec3f> positions) {
  return exec::reduce<Bounds>(ex, "octree.bounds", positions.size, frame::BoxOf{positions}, frame::Join{});
}

template <exec::Space Exec>
Frame fit_frame(Exec& ex, ArrayView<const Vec3f> positions, double scale) {
  if (positions.empty()) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  return frame_around(box_around(ex, positions), scale);
}

}  // namespace pointskin::octree
