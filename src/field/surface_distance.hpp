// How far points are from the surface of a field, to first order.
// Source: Taubin, "Distance approximations for rasterizing implicit curves", ACM TOG 13, 1994: |f| / |grad f|.
#pragma once

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"

namespace pointskin::field {

/// Where a point lies relative to a surface.
struct SurfaceDistance {
  float cells = 0;      ///< distance to first order in finest cells, positive outside; at most kFarCells either way
  Vec3f normal{};       ///< outward, unit length; zero where the field is flat
  float steepness = 0;  ///< length of the field's gradient, per finest cell
};

/// What takes the place of distances where the field is flat.
inline constexpr float kFarCells = 1000;

/// distances[i]: of points[i] in the unit cube. Good near the surface, too large far from it, the side is always right.
/// The gradient is interpolated between corners. About 60 values each after one descent, O(n depth).
template <exec::Space Exec>
void measure_distances(Exec& ex, const FieldView& f, ArrayView<const Vec3f> points,
                       ArrayView<SurfaceDistance> distances);

}  // namespace pointskin::field
