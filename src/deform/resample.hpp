// Samples of a deformed surface, as far apart as they were at rest: inserted where it stretches, thinned where it is
// squeezed.
// Source: Pauly, Keiser, Kobbelt & Gross, "Shape modeling with point-sampled geometry", SIGGRAPH 2003, section 5
// (dynamic sampling by the local stretch). Differs: how many samples come of one is decided by error diffusion along
// the Morton curve of the rest pose, with a prefix sum instead of splits and merges in turn, so every frame stands for
// itself.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "deform/deform_map.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"

namespace pointskin::deform {

/// Area stretches between 1 / this and this leave the samples alone: distances change by 15 % at most.
inline constexpr double kTolerated = 4.0 / 3;
/// Most samples that come of one.
inline constexpr double kMostCopies = 64;

/// The cloud at rest, in Morton order; shape (n) each. Places are relative to the cloud's origin, world units.
struct RestSamples {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const float> spacings;  ///< side of the square of the surface that a sample stands for, world units, > 0
};

/// The surface at rest.
struct RestSurface {
  field::FieldView field;
  octree::Frame frame;
};

/// Samples in the rest pose, in the order of the samples that they come of.
struct Resampled {
  exec::Buffer<Vec3f> positions, normals;
  exec::Buffer<std::int32_t> parents;  ///< (m) the rest sample
  std::int64_t inserted = 0, thinned = 0;
};

/// The rest samples that the map needs: with the area stretch s at a sample (1 where tolerated), S = 1/2 + sum of those
/// before it, it becomes floor(S + s) - floor(S) samples. One stays where it is. Several are spread over the sample's
/// square in its tangent plane, evenly along and across the direction of greatest stretch, and moved onto the surface
/// where the field's normal is theirs; where the surface is farther away than half of the square, they stay in the
/// plane.
/// @throws Error over_limit beyond 2^31 - 1 samples, empty_result if none is left
/// O(n (handles + control points)), three launches, two read-backs. Sums are integers: the same on every device.
template <exec::Space Exec>
Resampled resample(Exec& ex, const MapView& map, const RestSamples& samples, const RestSurface& surface);

/// Moves positions and normals of the rest pose in place. Normals follow the inverse transpose of the Jacobian and keep
/// their length; they stay outward where the map turns space inside out, and become 0 where it is flat.
template <exec::Space Exec>
void map_samples(Exec& ex, const MapView& map, ArrayView<Vec3f> positions, ArrayView<Vec3f> normals);

}  // namespace pointskin::deform
