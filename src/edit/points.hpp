// What the operations of a session do to the points of a cloud, on one space.
#pragma once

#include <pointskin/edit.hpp>

#include <string>

#include "exec/space.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::edit {

/// What an operation starts from.
struct EditInput {
  const detail::PointBuffers& points;  ///< relative to `origin`, all used, with PointBuffers::added
  const detail::FieldData& field;      ///< of these points, with samples
  Vec3d origin;
  Bounds base_box;           ///< of the original points
  double normal_length = 1;  ///< of normals that are made
  const Options& options;
};

/// The points after an operation, and what it did.
struct EditedPoints {
  detail::PointBuffers points;
  std::int64_t added = 0, removed = 0;
  bool snapped = false;

  [[nodiscard]] bool changed() const { return added > 0 || removed > 0; }
};

/// @throws Error usage, empty_result (no points left), over_limit, no_normals, invalid_input
template <exec::Space Exec>
EditedPoints edit_points(Exec& ex, const EditInput& input, const Operation& operation);

/// A copy of the points that are used, without PointBuffers::used.
template <exec::Space Exec>
detail::PointBuffers copy_used(Exec& ex, const detail::PointBuffers& points);

/// Throws before any work where an operation is not as described in edit.hpp.
/// @throws Error usage
void validate(const Operation& operation);

}  // namespace pointskin::edit
