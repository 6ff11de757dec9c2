// The cloud at rest as deformations need it: in Morton order, with its surface and the distances of its samples.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "deform/resample.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::deform {

/// The rest cloud. Arrays of shape (n) are in Morton order, ties by the bits of position and normal.
struct RestCloud {
  Vec3d origin{};
  exec::Buffer<Vec3f> caller_positions;             ///< in the caller's order, for lists of points
  exec::Buffer<Vec3f> positions, normals;           ///< (n)
  exec::Buffer<Vec3f> unit;                         ///< (n) positions in the cube of the field
  exec::Buffer<float> spacings;                     ///< (n) as RestSamples
  std::vector<detail::AttributeBuffer> attributes;  ///< (n) each, under the caller's names
  detail::FieldData field;

  [[nodiscard]] std::int64_t size() const { return positions.size(); }
  [[nodiscard]] RestSamples samples() const { return {positions.cview(), normals.cview(), spacings.cview()}; }
  [[nodiscard]] RestSurface surface() const { return {field.view(DomainFaces::closed), field.frame}; }
};

/// Makes a cloud ready that is on the device. Leaves strays out as `options` say.
/// @param points  relative to `origin`
template <exec::Space Exec>
RestCloud make_rest(Exec& ex, detail::PointBuffers points, const Vec3d& origin, const Options& options,
                    RunReport& report);

}  // namespace pointskin::deform
