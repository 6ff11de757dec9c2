// The mean length of normals: what their lengths are measured by where they stand for confidence.
#pragma once

#include <cmath>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/space.hpp"

namespace pointskin::poisson {

/// In double: floats of any size have a length.
PSK_HD inline double length_of(const Vec3f& n) {
  const double x = n.x;
  const double y = n.y;
  const double z = n.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Units of the sum of lengths, 2^-this, where these are about 1, as normals' mostly are.
inline constexpr int kLengthFraction = 64;

/// Shape (n), n > 0. O(n); one wait, three where lengths are far from 1. NaN if one is not finite.
/// The same bits on every device and in any order.
template <exec::Space Exec>
double mean_length(Exec& ex, ArrayView<const Vec3f> normals);

}  // namespace pointskin::poisson
