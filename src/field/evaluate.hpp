// The implicit function at arbitrary points (P8).
#pragma once

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"

#include <pointskin/vector.hpp>

namespace pointskin::field {

/// values[i] = f(points[i]); points in the unit cube, others are moved to its nearest point. One descent from the root
/// and one trilinear interpolation in the leaf each: nested hats make sums over levels unnecessary. O(n depth).
template <exec::Space Exec>
void evaluate(Exec& ex, const FieldView& f, ArrayView<const Vec3f> points, ArrayView<float> values);

}  // namespace pointskin::field
