// The labels of the samples at places of a block, which are those of the nearest sample, wherever it lies.
#pragma once

#include <cstdint>
#include <span>

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "field/attributes.hpp"
#include "octree/octree_data.hpp"
#include "scale/block_plan.hpp"
#include "scale/block_work.hpp"

namespace pointskin::scale {

/// The samples of a block and its ring, in the order of the whole.
struct LabelledSamples {
  const octree::OctreeData& tree;    ///< of them
  ArrayView<const Vec3f> positions;  ///< (n) in the unit cube
  std::span<const field::Label> labels;
};

/// Hands on what field::find_labels() finds of the whole cloud. Where the nearest sample of the block's own may not be that of the
/// whole, because the surface is farther from all of them than the ring is wide or no finer cells are near, the cells of level K
/// that may hold it are read.
/// @param points  (m) in the unit cube
/// @param keys    (m) of the vertices that these are: others than the block's own, and those on the upper faces of the cube, may get
///                the label of any sample; (0): all are its own
/// @throws Error as BlockWork
/// O(m log n), 8 bytes a point; for those far away, BlockOptions::part_samples at once, and a read of the samples around each 4,096
template <exec::Space Exec>
void find_labels_of_block(Exec& ex, const SharedOfBlocks& shared, const BlockRange& own, const LabelledSamples& samples,
                          ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys,
                          const field::TakeValues& take);

}  // namespace pointskin::scale
