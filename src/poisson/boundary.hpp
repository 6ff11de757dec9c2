// Unknowns that are held at 0 instead of being solved for: Dirichlet conditions.
#pragma once

#include <cstdint>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::poisson {

/// The unknowns that are solved for, as LevelView::unknowns has them all: shape (bricks of all levels), level-major,
/// bit s for the corner of node s. For SolveOptions::free_unknowns.
/// @param hold_faces  leaves out the corners on the faces of the cube: with u = 0 there the field has the Dirichlet
///                    instead of the natural condition
/// O(bricks), one byte each. Deterministic.
template <exec::Space Exec>
exec::Buffer<std::uint8_t> free_unknowns(Exec& ex, const octree::OctreeView& tree, bool hold_faces);

}  // namespace pointskin::poisson
