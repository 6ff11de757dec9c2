// Nearest points through the octree: depth first, nearest child first, pruned by distance.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// The tree with its points in key order, or with some of them.
struct SearchView {
  OctreeView tree;
  ArrayView<const Vec3f> positions;        ///< (n) in the unit cube
  ArrayView<const std::int32_t> ids;       ///< (n) the caller's ids; (0) where nobody asks for them
  ArrayView<const std::int32_t> before{};  ///< (points of the tree + 1) how many of the n points come before each of
                                           ///< them; empty: the n points are those of the tree

  /// First of the points that lie in a cell, or, for the cell after it, the first that does not.
  [[nodiscard]] PSK_HD std::int32_t first_of(const LevelView& level, std::int64_t cell) const {
    const std::int32_t first = level.point_begin[cell];
    return before.empty() ? first : before[first];
  }
};

/// ids[q k + i], squared[q k + i]: the i-th nearest point of query q and its squared distance, by ascending
/// (distance, id); places beyond the number of points hold id -1. Queries in unit cube coordinates, anywhere.
template <exec::Space Exec>
void find_nearest(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, int k,
                  ArrayView<std::int32_t> ids, ArrayView<float> squared);

/// places[q]: place in key order of the point nearest to query q, of several as near of the first; -1 if there is none.
/// The same point as find_nearest gives where ids ascend, found in a fraction of the time where points are as near as
/// the leaf is wide: then they are in the 27 cells around, and the tree is not walked.
template <exec::Space Exec>
void find_nearest_place(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries,
                        ArrayView<std::int32_t> places);

/// Points within a radius of each query, in key order.
struct WithinRadius {
  exec::Buffer<std::int32_t> begin;  ///< (queries + 1)
  exec::Buffer<std::int32_t> ids;
  exec::Buffer<float> squared;
};

/// @param radius  unit cube coordinates
/// Two passes of the same walk: count, then write.
/// @throws Error over_limit if there are more than 2^31 - 1 in all
template <exec::Space Exec>
WithinRadius find_within(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, float radius);

}  // namespace pointskin::octree
