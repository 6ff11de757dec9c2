// Lists of points of the rest cloud that handles name, ready for searches.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>
#include <vector>

#include "deform/rest.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::deform {

/// Chosen points of the rest cloud, ready for searches; and what has been found for the rest samples.
struct ChosenPoints {
  std::vector<std::int64_t> points;  ///< the caller's list
  exec::Buffer<Vec3f> positions;     ///< in its order
  exec::Buffer<Vec3f> sorted_unit;
  exec::Buffer<std::int32_t> order;
  octree::OctreeData tree;
  exec::Buffer<std::int32_t> nearest_at_rest;  ///< (n) index in `positions`
  bool in_use = false;
};

/// (lists)
using PointLists = std::vector<std::vector<std::int64_t>>;

/// Makes the lists ready that are new in `chosen`, and forgets those that are no longer used.
template <exec::Space Exec>
void choose_points(Exec& ex, const RestCloud& rest, const PointLists& lists, std::vector<ChosenPoints>& chosen);

/// For every rest sample the nearest point of every list, shape (lists, n).
/// @param chosen  has all of the lists
template <exec::Space Exec>
exec::Buffer<Vec3f> nearest_at_rest(Exec& ex, const RestCloud& rest, const PointLists& lists,
                                    const std::vector<ChosenPoints>& chosen);

/// The same for other points of the rest pose, shape (lists, m). A search for each.
template <exec::Space Exec>
exec::Buffer<Vec3f> nearest_to(Exec& ex, const RestCloud& rest, const PointLists& lists,
                               const std::vector<ChosenPoints>& chosen, ArrayView<const Vec3f> positions);

}  // namespace pointskin::deform
