// The camera that fills the picture: its frustum touches what is seen.
#pragma once

#include <optional>

#include "exec/cpu.hpp"
#include "render/fit_points.hpp"
#include "render/view_axes.hpp"

namespace pointskin::render_detail {

/// How points are measured: ((p - centre) / radius) along the axes.
struct ViewSpace {
  ViewAxes axes;
  Vec3d centre{0, 0, 0};
  double radius = 1;
};

/// Half the width and height of what a picture may show, at unit depth (perspective), in pixels (orthographic).
struct HalfExtent {
  double x = 1, y = 1;
};

/// A viewer whose picture the points fill.
struct FittedView {
  double x = 0, y = 0;    ///< of the middle of the picture, radii to the right and upwards of the centre
  double distance = 0;    ///< perspective: viewer to the plane through the centre, radii
  double per_radius = 1;  ///< orthographic: pixels per radius
};

/// Perspective: the nearest viewer that has all points within `half`, with as much room to the left as to the right and
/// above as below. Never nearer to a point than kLeastDistance. @param centred  false: the centre stays in the middle
FittedView fit_perspective(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const HalfExtent& half,
                           bool centred);
/// Orthographic: the same, of largest scale; 1 radius for points that are all at one place.
FittedView fit_orthographic(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const HalfExtent& half,
                            bool centred);

/// A perspective viewer keeps this distance from what is seen, in radii: points in a line would draw it onto them.
inline constexpr double kLeastDistance = 0.05;

}  // namespace pointskin::render_detail
