// Stray points: a few points so far from all others that the working cube would be made for them.
//
// The core is a box that keeps all but a few points. Whatever lies within its longest side from it belongs to it, which
// makes it grow until it stands alone; what is then still outside, a gap as wide as the whole core away, is stray.
// Only minima, maxima and counts decide, so the answer is the same on every device, for any number of threads and any
// order of the points. docs/decisions/0016-stray-points.md has the reasons for the constants.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"

namespace pointskin::octree {

/// Reports list so many strays.
inline constexpr std::size_t kMostReported = 10;

/// Strays with their places, the farthest first, and the bounding box of the other points.
struct StrayPoints {
  std::vector<std::int32_t> indices;
  std::vector<Vec3f> positions;
  Bounds core;

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(indices.size()); }
};

/// What tells of most clouds that no point is a stray: the box of all points, and the part of space that the boxes of all lanes
/// (exec/reduce_order.hpp) have in common. Along every axis, each lane has a point at or beyond either end; the ends are in wrong
/// order where the lanes are apart.
struct Extent {
  Bounds all, inner;
};

/// Finds the strays of `positions`, at most stray_limit(n) of them (core/stray_limit.hpp).
/// @param positions  shape (n), finite
/// @throws Error empty_result if there are no points
/// O(n), on the device one reduction and one wait, as for the bounding box alone. Where points lie farther out than
/// that can rule out, O(n) twice more, up to 8 n bytes of scratch and four waits.
template <exec::Space Exec>
StrayPoints find_strays(Exec& ex, ArrayView<const Vec3f> positions);

/// The same where the extent of the points is known (octree/extent.hpp): without that reduction and its wait.
template <exec::Space Exec>
StrayPoints find_strays_in(Exec& ex, ArrayView<const Vec3f> positions, const Extent& extent);

/// The points outside of a cube, as strays: those that turned out to belong to no surface, of points around a core that do.
/// Of the places, the first kMostReported are the farthest from the core; the others are in no order.
/// O(n), two waits, 16 bytes of host memory for every point outside.
template <exec::Space Exec>
StrayPoints find_outside(Exec& ex, ArrayView<const Vec3f> positions, const Frame& cube, const Bounds& core);

/// Indices of the points that are no strays, ascending; an empty array if there are no strays.
/// @param n  number of all points
template <exec::Space Exec>
exec::Buffer<std::int32_t> without_strays(Exec& ex, std::int64_t n, const StrayPoints& strays);

namespace strays {

/// The points among which all strays are.
struct Candidates {
  std::vector<std::int32_t> indices;
  std::vector<Vec3f> positions;
};

/// True unless it is certain that there are no strays.
/// @param all    bounding box of all points
/// @param inner  on either side of its upper and of its lower end, along every axis, are more points than may be strays
bool may_have_strays(const Bounds& all, const Bounds& inner);

/// The `rank`-th smallest lower and the `rank`-th largest upper ends of boxes, counted from 0, along every axis.
Bounds ends_of(const std::vector<Bounds>& boxes, std::int64_t rank);

/// Decides which candidates are strays.
/// @param candidates  all points beyond `ends`
/// @param ends        along every axis, more than `limit` points lie at or below the lower one, and at or above the
/// upper
/// @param all         bounding box of all points
/// @param limit       most strays
/// O(candidates + limit^2 rounds), on the host.
StrayPoints choose_strays(const Candidates& candidates, const Bounds& ends, const Bounds& all, std::int64_t limit);

/// All candidates as strays, those that are reported first.
StrayPoints as_strays(const Candidates& candidates, const Bounds& core);

}  // namespace strays
}  // namespace pointskin::octree
