// The bounding box of points, as a reduction.
#pragma once

#include <cstdint>
#include <pointskin/cloud.hpp>

#include "core/array_view.hpp"

namespace pointskin::octree {

struct BoxOf {
  ArrayView<const Vec3f> positions;
  PSK_HD Bounds operator()(std::int64_t i) const { return {positions[i], positions[i]}; }
};

struct JoinBoxes {
  static constexpr bool kAnyOrder = true;
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

}  // namespace pointskin::octree
