// The working cube of a run and the points that it is made for, once for every space.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "octree/frame.hpp"
#include "octree/strays.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::detail {

inline void report_strays(const octree::StrayPoints& strays, RunReport& report) {
  report.strays = strays.size();
  for (std::size_t i = 0; i < std::min(octree::kMostReported, strays.positions.size()); ++i) {
    const Vec3f& p = strays.positions[i];
    report.farthest_strays.push_back({p.x, p.y, p.z});
  }
}

/// The working cube; leaves strays out of the points that are used, unless they are to be kept.
/// @param extent  of all points, where it is known
template <exec::Space Exec>
octree::Frame fit_cube(Exec& ex, PointBuffers& points, const Options& options, RunReport& report,
                       const std::optional<octree::Extent>& extent = {}) {
  const ArrayView<const Vec3f> positions = points.positions.cview();
  report.strays = 0;
  report.farthest_strays.clear();
  if (options.keep_strays)
    return extent ? octree::frame_around(extent->all, options.scale) : octree::fit_frame(ex, positions, options.scale);
  const octree::StrayPoints strays =
      extent ? octree::find_strays_in(ex, positions, *extent) : octree::find_strays(ex, positions);
  report_strays(strays, report);
  leave_out(ex, strays, points);
  return octree::frame_around(strays.core, options.scale);
}

/// FitSetup::core around samples that are no outliers, or none if a cube for them would hardly be smaller.
/// @param box  of these samples, in the unit cube of `frame`
inline std::optional<Bounds> core_in(const Bounds& box, const octree::Frame& frame, double scale) {
  constexpr double kWorthIt = 0.95;  // of the cube's side
  const Bounds core{frame.to_world(box.lower), frame.to_world(box.upper)};
  if (!(box.lower.x < box.upper.x) || octree::frame_around(core, scale).size > kWorthIt * frame.size)
    return std::nullopt;
  return core;
}

/// The working cube around FitSetup::core; leaves the points outside of it out of those that are used.
template <exec::Space Exec>
octree::Frame cube_around(Exec& ex, const Bounds& core, PointBuffers& points, const Options& options,
                          RunReport& report) {
  report.farthest_strays.clear();
  const octree::Frame cube = octree::frame_around(core, options.scale);
  const octree::StrayPoints outside = octree::find_outside(ex, points.positions.cview(), cube, core);
  report_strays(outside, report);
  leave_out(ex, outside, points);
  return cube;
}

}  // namespace pointskin::detail
