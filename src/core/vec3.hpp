// Lengths of vectors and their change of precision, on every device with the same bits.
#pragma once

#include <pointskin/vector.hpp>

#include <cmath>

#include "core/host_device.hpp"

namespace pointskin {

PSK_HD inline Vec3d to_double(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
PSK_HD inline Vec3f to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

template <class T>
PSK_HD inline T length(const Vec3<T>& v) {
  return std::sqrt(squared_length(v));
}

/// `v` at unit length, or zero if `v` has no length.
PSK_HD inline Vec3d normalized(const Vec3d& v) {
  const double l = length(v);
  return l > 0 ? 1 / l * v : Vec3d{};
}

}  // namespace pointskin
