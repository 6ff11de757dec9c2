// The mean length of normals: what their lengths are measured by where they stand for confidence.
#pragma once

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/space.hpp"

namespace pointskin::poisson {

/// Shape (n), n > 0. O(n); one wait, three where lengths are far from 1. NaN if one is not finite.
/// The same bits on every device and in any order.
template <exec::Space Exec>
double mean_length(Exec& ex, ArrayView<const Vec3f> normals);

}  // namespace pointskin::poisson
