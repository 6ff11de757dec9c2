// Points that guide the surface: a stroke extruded along the view, or an area filled in volume.
// Source: Zhou et al. 2010, section 5.1, steps 1 to 5 (but edit/normals_around.hpp). Differs: the points of all layers
// are candidates of one launch, and only those that are kept are written.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "edit/polygons.hpp"
#include "edit/view_frame.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"

namespace pointskin::edit {

/// What is to be filled with points, in plane coordinates: a polyline, or the inside of polygons.
struct GuideShape {
  std::vector<PlanePoint> stroke;  ///< empty: the polygons count
  std::vector<PlaneEdge> edges;
  double interval = 0;                     ///< of layers and of the points in them, world units, > 0
  double first_depth = 0, last_depth = 0;  ///< of layers, world units in front of the eye
};

/// Depths in front of the eye between which a box lies (step 1); in a perspective view not below `nearest`.
struct DepthRange {
  double first = 0, last = 0;
};
DepthRange depth_range(const ViewFrame& view, const Bounds& box, double nearest);

/// Keeps a point if it is in the unit cube and, with `inside_only`, inside of the surface of `field` (steps 3, 4).
struct KeepInside {
  field::FieldView field;
  octree::Frame cube;
  bool inside_only = true;
};

struct GuidePoints {
  exec::Buffer<Vec3f> positions;  ///< relative to the cloud's origin, world units
  exec::Buffer<Vec3f> normals;    ///< to the right of the stroke; (0) unless they were asked for
};

/// Steps 1 to 4, and the second kind of normals of step 5.
/// @param stroke_normals  fill GuidePoints::normals; the stroke must have a length
/// @throws Error over_limit if there are more than 2^31 - 1 candidates
/// O(candidates (depth + edges)), two launches and a round trip. Deterministic.
template <exec::Space Exec>
GuidePoints guide_points(Exec& ex, const ViewFrame& view, const GuideShape& shape, const KeepInside& keep,
                         bool stroke_normals);

}  // namespace pointskin::edit
