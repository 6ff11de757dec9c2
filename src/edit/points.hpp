// The points of a session and how an operation changes them, on one space.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "edit/point_kind.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::edit {

/// What an operation does to the points: it adds some, removes some or turns the normals of some.
struct Change {
  detail::PointBuffers added{};          ///< relative to the session's origin; attributes may be of other names
  std::uint8_t kind = kGuide;            ///< of the added ones
  exec::Buffer<std::int32_t> removed{};  ///< indices, ascending
  exec::Buffer<std::int32_t> flipped{};  ///< indices, ascending
  bool snapped = false;                  ///< Insert::snap found points to snap to

  [[nodiscard]] bool is_none() const { return added.positions.empty() && removed.empty() && flipped.empty(); }
};

/// The points after a change. O(points), copies all.
/// @throws Error empty_result (no points left), over_limit
template <exec::Space Exec>
detail::PointBuffers changed_points(Exec& ex, const detail::PointBuffers& points, const Change& change);

/// The points of these indices.
template <exec::Space Exec>
detail::PointBuffers choose(Exec& ex, const detail::PointBuffers& points, ArrayView<const std::int32_t> indices);

/// A copy of the points that are used, without PointBuffers::used.
template <exec::Space Exec>
detail::PointBuffers copy_used(Exec& ex, const detail::PointBuffers& points);

/// n -> -n for the normals of these indices.
template <exec::Space Exec>
void turn_normals(Exec& ex, ArrayView<const std::int32_t> chosen, ArrayView<Vec3f> normals);

}  // namespace pointskin::edit
