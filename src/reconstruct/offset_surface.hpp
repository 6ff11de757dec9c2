// The field of a surface at a distance from that of another field, once for every space: after the fit.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstdint>

#include "exec/algorithms.hpp"
#include "field/offset.hpp"
#include "octree/bounding_box.hpp"
#include "octree/frame.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/phase_clock.hpp"

namespace pointskin::detail {

/// The cube that a surface in `vertices` is offset in: `cube` where that has room for it and a cell beyond, else one
/// around the surface grown by the offset.
/// @param vertices  in the unit cube of `cube`, at least one
/// @param distance  world units
template <exec::Space Exec>
octree::Frame cube_for_offset(Exec& ex, const octree::Frame& cube, ArrayView<const Vec3f> vertices, int depth,
                              double distance) {
  constexpr double kRoom = 1.1;  // as Options::scale, whatever that is
  if (distance <= 0) return cube;
  const Bounds box =
      exec::reduce<Bounds>(ex, "offset.box", vertices.size, octree::BoxOf{vertices}, octree::JoinBoxes{});
  const double reach = distance / cube.size + 1.5 / static_cast<double>(std::int64_t{1} << depth);
  const double lowest = std::min({box.lower.x, box.lower.y, box.lower.z});
  const double highest = std::max({box.upper.x, box.upper.y, box.upper.z});
  if (lowest - reach >= 0 && highest + reach <= 1) return cube;
  const auto grown = [&](const Vec3f& corner, double by) {
    const Vec3f p = cube.to_world(corner);
    return Vec3f{static_cast<float>(p.x + by), static_cast<float>(p.y + by), static_cast<float>(p.z + by)};
  };
  return octree::frame_around({grown(box.lower, -distance), grown(box.upper, distance)}, kRoom);
}

/// The field whose surface lies options.offset away from that of `field`, which stays as it is.
/// @throws Error empty_result if either has no surface, over_limit
template <exec::Space Exec>
FieldData offset_surface(Exec& ex, const FieldData& field, const Options& options, RunReport& report) {
  PhaseClock clock(ex);
  Options plain = options;
  plain.normals = false;
  plain.largest = false;  // pieces are those of the offset surface
  plain.min_component = 0;
  const surface::Surface surface = extract(ex, field, plain, report);
  if (surface.triangles.empty())
    throw Error(ErrorCode::empty_result, "the surface has no triangles; are the normals oriented consistently?");

  FieldData result;
  const int depth = field.tree.depth;
  result.frame = cube_for_offset(ex, field.frame, surface.positions.cview(), depth, options.offset);
  const double cells = options.offset / result.frame.size * static_cast<double>(std::int64_t{1} << depth);
  field::OffsetField made = field::make_offset(
      ex, {field.view(options.domain_faces), field.frame, surface.positions.cview(), surface.triangles.cview()},
      result.frame, depth, cells);
  result.tree = std::move(made.tree);
  result.values = std::move(made.values);
  result.isovalue = -cells;
  clock.lap(report.offset.ms);
  clock.read();
  report.isovalue = result.isovalue;
  report.offset.cells = cells;
  report.offset.cube_growth = result.frame.size / field.frame.size;
  report.offset.triangles = surface.triangles.size();
  report.offset.band_cells = made.band_cells;
  return result;
}

}  // namespace pointskin::detail
