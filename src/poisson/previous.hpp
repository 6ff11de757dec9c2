// A solve that starts from the field of nearly the same samples.
//
// On every level the new field begins as the interpolation of the level above plus what the field before had added to
// its own interpolation: where nothing has changed, that is the field before, and where the levels above have changed,
// their change comes through. Corners that are no unknowns keep the interpolated value alone, as without a start.
#pragma once

#include <cstdint>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/view.hpp"

namespace pointskin::poisson {

/// A field before, in the same cube and of the same depth.
struct PreviousField {
  octree::OctreeView tree;
  const float* u = nullptr;              ///< over the nodes of all its levels; null: there is none
  const std::int32_t* bricks = nullptr;  ///< (bricks of all levels of the new tree) the brick of `tree` at the same
                                         ///< place, local to the level, or -1
};

/// PreviousField::bricks, each by its way from the root: O(bricks D), one launch. Deterministic.
template <exec::Space Exec>
exec::Buffer<std::int32_t> match_bricks(Exec& ex, const octree::OctreeView& tree, const octree::OctreeView& old_tree);

}  // namespace pointskin::poisson
