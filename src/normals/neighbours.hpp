// The nearest points of every point of a cloud, all at once.
#pragma once

#include <cstdint>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/search.hpp"

namespace pointskin::normals {

/// Nearest points that are kept for every point: enough for a plane and a quadric, and the links of the graph that
/// signs are propagated along.
inline constexpr int kNeighbours = 16;

/// ids[kNeighbours i + j]: the j-th nearest of the other points, by (distance, index), as an index in the order of the
/// tree; -1 beyond the last.
/// @param points  positions in key order; ids are not used
/// Exact. The 27, then 125 cells around are searched on the level whose cells hold a few points, else a walk from the
/// root: about 100 distances a point where samples are even. 64 n bytes. Deterministic.
template <exec::Space Exec>
exec::Buffer<std::int32_t> find_neighbours(Exec& ex, const octree::SearchView& points);

}  // namespace pointskin::normals
