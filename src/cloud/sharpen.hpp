// The field of a set operation's result near the curve in which both surfaces cross, made of both solids' fields.
// Source: Ricci, "A constructive geometry for computer graphics", The Computer Journal 16, 1973: the union,
// intersection and difference of solids are the maximum, the minimum and the minimum with a complement of their
// functions. Differs: of distances to first order, and only near the curve.
#pragma once

#include <pointskin/boolean.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "field/surface_distance.hpp"

namespace pointskin::cloud {

/// Corners at most this far from both surfaces, in finest cells, take the combined value; farther ones less of it, and
/// none from kBlendEnd on.
inline constexpr float kBlendStart = 1.5F;
inline constexpr float kBlendEnd = 3.0F;

/// Where the two halves of a symmetric difference touch, both end this much before, in finest cells: at the curve, and
/// less up to kApartEnd from it. So no cell holds a corner of both, and the surface does not jump between them.
inline constexpr float kApart = 1.2F;
inline constexpr float kApartEnd = 1.5F;

/// How deep a point is inside of the result, in finest cells, from the distances to A and B (positive outside).
PSK_HD inline float combined_depth(BooleanOp op, float a, float b) {
  const float smaller = a < b ? a : b;
  const float larger = a < b ? b : a;
  switch (op) {
    case BooleanOp::unite:
      return -smaller;
    case BooleanOp::intersect:
      return -larger;
    case BooleanOp::subtract:
      return -a < b ? -a : b;
    case BooleanOp::symmetric_difference:
      break;
  }
  const float in_one = -smaller < larger ? -smaller : larger;
  const float from_a = a < 0 ? -a : a;
  const float from_b = b < 0 ? -b : b;
  const float from_curve = from_a > from_b ? from_a : from_b;
  return from_curve < kApartEnd ? in_one - kApart * (1 - from_curve / kApartEnd) : in_one;
}

/// Share of the combined value that a corner takes: 1 near the curve, 0 far from it and where the surfaces run alike,
/// whose distances would only add up their noise.
PSK_HD inline float blend_share(const field::SurfaceDistance& a, const field::SurfaceDistance& b) {
  const float from_a = a.cells < 0 ? -a.cells : a.cells;
  const float from_b = b.cells < 0 ? -b.cells : b.cells;
  const float far = from_a > from_b ? from_a : from_b;
  const float dot = a.normal.x * b.normal.x + a.normal.y * b.normal.y + a.normal.z * b.normal.z;
  const float cosine = dot < 0 ? -dot : dot;
  const float near_share = (kBlendEnd - far) / (kBlendEnd - kBlendStart);
  const float crossing_share = (0.95F - cosine) / 0.1F;  // around kCoincidentCosine
  const float share = near_share < crossing_share ? near_share : crossing_share;
  return share < 0 ? 0.0F : share > 1 ? 1.0F : share;
}

/// Blends the combined values into those of the result's corners.
/// @param a, b       fields of both solids, in the result's cube and of its depth
/// @param steepness  of the values that are made, per finest cell
/// @param tree       of the result
/// @param values     its values over the nodes of all levels
/// Every corner's value depends on its old one and on its place alone, so corners of several levels still agree.
/// O(nodes depth), and 60 values at corners near both surfaces. Deterministic, the same bits on every device.
template <exec::Space Exec>
void sharpen(Exec& ex, const field::FieldView& a, const field::FieldView& b, BooleanOp op, double steepness,
             const octree::OctreeView& tree, float isovalue, ArrayView<float> values);

}  // namespace pointskin::cloud
