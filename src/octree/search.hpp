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
  ArrayView<const std::int32_t> ids;       ///< (n) the caller's ids; empty: 0, 1, ..., n - 1
  ArrayView<const std::int32_t> before{};  ///< (points of the tree + 1) how many of the n points come before each of
                                           ///< them; empty: the n points are those of the tree

  [[nodiscard]] PSK_HD std::int32_t id_of(std::int32_t i) const { return ids.empty() ? i : ids[i]; }
};

/// ids[q k + i], squared[q k + i]: the i-th nearest point of query q and its squared distance, by ascending
/// (distance, id); places beyond the number of points hold id -1. Queries in unit cube coordinates, anywhere.
template <exec::Space Exec>
void find_nearest(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, int k,
                  ArrayView<std::int32_t> ids, ArrayView<float> squared);

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
