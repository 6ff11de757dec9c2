// What implicit functions are put together with.
#pragma once

#include <algorithm>
#include <cmath>

#include "shapes.hpp"

namespace pointskin::bench {

inline double length(const Vec3d& a) { return std::sqrt(dot(a, a)); }

/// A direction even where `a` vanishes, so that gradients stay finite.
inline Vec3d direction(const Vec3d& a) {
  const double norm = length(a);
  return norm > 0 ? a * (1 / norm) : Vec3d{0, 0, 1};
}

/// Smooth maximum: max(a, b) + k/4 (max(k - |a - b|, 0) / k)^2, once differentiable, exact where |a - b| >= k.
inline Sample smooth_max(const Sample& a, const Sample& b, double k) {
  const double gap = a.value - b.value;
  const double h = std::max(k - std::abs(gap), 0.0) / k;
  const double weight = gap >= 0 ? 1 - h / 2 : h / 2;  // d smooth_max / d a
  return {std::max(a.value, b.value) + k / 4 * h * h, a.gradient * weight + b.gradient * (1 - weight)};
}

/// Smooth minimum, as above: joins two solids with a fillet about k / 4 wide.
inline Sample smooth_min(const Sample& a, const Sample& b, double k) {
  const Sample most = smooth_max({-a.value, -a.gradient}, {-b.value, -b.gradient}, k);
  return {-most.value, -most.gradient};
}

}  // namespace pointskin::bench
