// The two halves of a symmetric difference touch along the curve in which the surfaces cross. On a grid, their contact
// would come and go from cell to cell, a handle each time. So the field is lowered there, and both halves end before.
#pragma once

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "field/surface_distance.hpp"

namespace pointskin::boolean {

/// How far the surfaces move inwards at the curve, in finest cells as far as the field is linear; less up to kApartEnd
/// cells from it. Measured in docs/decisions/0022-booleans.md.
inline constexpr float kApart = 0.6F;
inline constexpr float kApartEnd = 1.5F;

/// How much the field is lowered, in cells, at a point this far from both surfaces; not at all where they run alike.
PSK_HD inline float lowered_by(const field::SurfaceDistance& a, const field::SurfaceDistance& b) {
  const float from_a = a.cells < 0 ? -a.cells : a.cells;
  const float from_b = b.cells < 0 ? -b.cells : b.cells;
  const float far = from_a > from_b ? from_a : from_b;
  const float dot = a.normal.x * b.normal.x + a.normal.y * b.normal.y + a.normal.z * b.normal.z;
  const float cosine = dot < 0 ? -dot : dot;
  const float crossing = (0.95F - cosine) / 0.1F;  // falls to 0 around kCoincidentCosine
  const float share = crossing < 0 ? 0.0F : crossing > 1 ? 1.0F : crossing;
  return far < kApartEnd ? kApart * share * (1 - far / kApartEnd) : 0.0F;
}

/// Lowers the values of the result's corners near the curve.
/// @param a, b       fields of both solids, in the result's cube and of its depth
/// @param steepness  of the result's field, per finest cell
/// @param tree       of the result
/// @param values     its values over the nodes of all levels
/// What is taken off depends on a corner's place alone, so corners of several levels still agree, and corners next to
/// coarser leaves are interpolated again: the field stays continuous.
/// O(nodes depth), and 60 values at corners near both surfaces. Deterministic, the same bits on every device.
template <exec::Space Exec>
void keep_apart(Exec& ex, const field::FieldView& a, const field::FieldView& b, double steepness,
                const octree::OctreeView& tree, ArrayView<float> values);

}  // namespace pointskin::boolean
