// The points that a view shows in an area.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "edit/polygons.hpp"
#include "edit/view_frame.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"

namespace pointskin::edit {

/// Indices of the points inside of the polygons, at any depth in front of the eye, ascending.
/// @param positions   shape (n), relative to the cloud's origin, world units
/// @param candidates  shape (n); 0: the point is not chosen wherever it is; empty: all may be
/// O(n edges). Deterministic.
template <exec::Space Exec>
exec::Buffer<std::int32_t> points_in(Exec& ex, const ViewFrame& view, const Polygons& area,
                                     ArrayView<const Vec3f> positions, ArrayView<const std::uint8_t> candidates);

/// What may stand between the eye and points.
struct Screen {
  field::FieldView field;  ///< of samples
  octree::Frame cube;
  /// False: the inside of the surface hides what is behind it. True: only the surface itself hides, and only where there
  /// are samples: in the leaf in which a line of sight crosses it or, if the leaf is no wider than that of the point,
  /// in one of those around it. So points whose normals are wrong are not hidden by what the surface makes of them.
  bool only_at_samples = false;
};

/// Those of `chosen` that the screen does not hide, in their order.
///
/// A point is hidden by what its line of sight meets farther than kSurfaceCells cells before it, cells being those that
/// count where the point is. The line is followed from leaf to leaf of the octree, towards the eye, and the field is
/// looked at in the middle of each leaf and where the line leaves it: what is thinner than half a leaf may be missed.
/// In an orthographic view the eye is infinitely far away.
/// Differs from the depth buffer of a picture: no picture is drawn, and no pixel decides for its neighbours.
/// @param chosen  indices of points in front of the eye, ascending
/// O(chosen leaves depth), leaves being those that a line crosses: at most 3 * 2^depth, a few dozen in practice, since
/// leaves are wide away from the surface. One launch, a round trip, 4 bytes a point. Deterministic, the same bits on
/// every device.
template <exec::Space Exec>
exec::Buffer<std::int32_t> not_hidden(Exec& ex, const ViewFrame& view, const Screen& screen,
                                      ArrayView<const Vec3f> positions, ArrayView<const std::int32_t> chosen);

inline constexpr double kSurfaceCells = 2;  ///< points so near behind the surface belong to it

/// Indices in [0, n) that are not among `chosen`, ascending. O(n), n bytes of scratch.
/// @param chosen  no index twice
template <exec::Space Exec>
exec::Buffer<std::int32_t> all_but(Exec& ex, std::int64_t n, ArrayView<const std::int32_t> chosen);

}  // namespace pointskin::edit
