// Attributes where a cloud is worked on in blocks (poisson/in_blocks.hpp): what levels up to K hold of them is given, and what a
// block finds of level K at its own nodes is for others to have. Means are pulled from one level to the next within a cell, and
// pushed from as near, so that of level K two cells of a ring reach.
//
// Each function is defined in attributes.cpp, and made of what interpolate() is made of.
#pragma once

#include <cstddef>
#include <span>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/attributes.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field {

/// Samples in the octree's order, with the channels of a pass: 1 to kAttributesAtOnce that miss the same samples. How channels are
/// put together in passes changes no bit of theirs.
struct ChannelSamples {
  ArrayView<const Vec3f> positions;
  ArrayView<const float> weights;  ///< as AttributeSamples has them
  std::span<const Channel> channels;
};

/// Pulls means up to level `level`: right at corners around which all samples are there. O(8 n + 27 nodes of these levels).
/// @returns shape (nodes of all levels, 1 + channels): weight and means; levels above `level` are not set
template <exec::Space Exec>
exec::Buffer<float> channel_means_below(Exec& ex, const octree::OctreeData& tree, const ChannelSamples& samples,
                                        int level);

/// Pulls the means of an octree's finest level up to the root, and pushes values down again. O(35 nodes).
/// @param values  shape (nodes of all levels, 1 + channels), with the means of the finest; receives the values of all
template <exec::Space Exec>
void finish_coarse_channels(Exec& ex, const octree::OctreeData& tree, std::size_t channels, ArrayView<float> values);

/// Interpolates the channels at points of the unit cube, as interpolate() does, and hands them on.
/// @param given  shape (nodes of levels 0..`level`, 1 + channels): the values of these levels
/// O(8 n + 27 nodes + points depth), 4 (1 + channels) bytes a node.
template <exec::Space Exec>
void interpolate_below(Exec& ex, const octree::OctreeData& tree, const ChannelSamples& samples, int level,
                       ArrayView<const float> given, ArrayView<const Vec3f> points, const TakeValues& take);

}  // namespace pointskin::field
