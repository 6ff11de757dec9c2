// Normals of points that have none, from the samples around them.
// Source: Zhou et al. 2010, section 5.1, step 5: weights 1 / distance^2 over the samples in a box that grows until it
// holds some. Differs: the box grows with the cells of the octree, and where it is wide, the samples of a cell count as
// one: far inside of a surface a box that reaches it holds thousands.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "octree/view.hpp"

namespace pointskin::edit {

/// Samples with normals to interpolate from, in the order of the tree's keys.
struct NormalSamples {
  octree::OctreeView tree;
  ArrayView<const Vec3f> positions;      ///< in the unit cube
  ArrayView<const Vec3f> normals;        ///< unit length or zero
  ArrayView<const std::uint8_t> counts;  ///< 0: the sample does not count; empty: all do
};

/// Normals at `points`, of unit length; zero where all cancel, or nothing counts. The box is made of the 27 cells
/// around that of the point, on the finest level where one of them holds a sample that counts. On the finest level of
/// all, every sample has its weight; above, those of a child cell are one at their mean position.
/// @param points  relative to the cloud's origin, world units
/// O(nodes) once, 28 bytes a cell of scratch, and at most 216 clusters each. Deterministic, the same bits on every
/// device.
template <exec::Space Exec>
exec::Buffer<Vec3f> interpolate_normals(Exec& ex, const NormalSamples& samples, const octree::Frame& cube,
                                        ArrayView<const Vec3f> points);

}  // namespace pointskin::edit
