// What the operations of a session do to the points of a cloud, on one space.
#pragma once

#include <pointskin/edit.hpp>

#include <cstdint>

#include "edit/points.hpp"
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

/// @param operation  valid
/// @throws Error usage, over_limit, no_normals, invalid_input
template <exec::Space Exec>
Change find_change(Exec& ex, const EditInput& input, const Operation& operation);

/// Guide::interval, or for 0 the width of the finest cells, world units.
inline double interval_of(const Guide& guide, const detail::FieldData& field) {
  const double cell = field.frame.size / static_cast<double>(std::int64_t{1} << field.tree.depth);
  return guide.interval > 0 ? guide.interval : cell;
}

/// Throws before any work where an operation is not as described in edit.hpp.
/// @throws Error usage
void validate(const Operation& operation);

}  // namespace pointskin::edit
