// The curve in which the surfaces of two fields cross, and samples of both surfaces along it.
#pragma once

#include <pointskin/boolean.hpp>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "field/surface_distance.hpp"

namespace pointskin::boolean {

/// Points of the curve, about two a cell: at most one in every eighth of a leaf, the point of the curve that Newton's
/// method reaches from its middle.
struct Crease {
  exec::Buffer<Vec3f> points;                       ///< (n) in the unit cube, by Morton key of the first field's leaves
  exec::Buffer<float> widths;                       ///< (n) of these eighths, in finest cells
  exec::Buffer<field::SurfaceDistance> to_a, to_b;  ///< (n) of the points, near 0; with the surfaces' normals
  double length_unit = 0;                           ///< of the curve, unit cube

  [[nodiscard]] std::int64_t size() const { return points.size(); }
};

/// Both fields in one cube, of one depth. Where the surfaces run alike (kCoincidentCosine) there is no curve.
/// The length is that of the curve's tangents in the eighths that they pass through.
/// O(nodes of a), and 40 values at every leaf that both surfaces pass through. Deterministic, the same bits everywhere.
template <exec::Space Exec>
Crease find_crease(Exec& ex, const field::FieldView& a, const field::FieldView& b);

/// Oriented samples in the unit cube.
struct SheetSamples {
  exec::Buffer<Vec3f> positions, normals;
};

/// Samples of the parts of both surfaces that the operation keeps, in rows along the curve: on the surface, a fraction
/// of a cell away from the curve, with the surface's normal, turned round where the operation flips it.
template <exec::Space Exec>
SheetSamples sample_sheets(Exec& ex, const field::FieldView& a, const field::FieldView& b, const Crease& crease,
                           BooleanOp op);

/// Mean of the fields' steepness at the curve, per finest cell. The crease has points.
template <exec::Space Exec>
double steepness_at(Exec& ex, const Crease& crease);

}  // namespace pointskin::boolean
