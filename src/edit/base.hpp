// The cloud that a session begins with: which of its points are original, and its first field.
#pragma once

#include <pointskin/edit.hpp>

#include <memory>

#include "envelope/envelope.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::edit {

inline constexpr const char* kKinds = "added";  ///< attribute of edited clouds: edit/point_kind.hpp

/// A session's beginning, but for the surface.
struct BaseFit {
  detail::PointBuffers points;  ///< without strays, with PointBuffers::added
  detail::FieldData field;
  Bounds box;                ///< of the original points
  double normal_length = 1;  ///< mean length of theirs with Options::confidence
};

/// Fits the field of a base cloud. With EditOptions::continued the cube is that of the original points as long as it
/// holds all of them well, as in the session that the cloud is from (docs/decisions/0037-front-layer-and-continued-sessions.md).
/// @throws Error as Reconstructor::solve; invalid_input as EditSession
template <exec::Space Exec>
BaseFit fit_base(Exec& ex, const Cloud& base, const EditOptions& options,
                 const std::shared_ptr<const envelope::Envelope>& envelope);

/// The cube before if all points are well inside of it, else one around them.
template <exec::Space Exec>
octree::Frame cube_for(Exec& ex, const octree::Frame& before, const detail::PointBuffers& points, double scale);

}  // namespace pointskin::edit
