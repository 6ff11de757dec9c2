// What the public Octree holds, and what it asks of a space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <pointskin/octree.hpp>

#include "exec/any_space.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "octree/search.hpp"

namespace pointskin::octree {

/// A tree with its points, in a space.
struct BuiltOctree {
  Frame frame;
  OctreeData data;
  exec::Buffer<std::int32_t> order;
  exec::Buffer<Vec3f> positions;  ///< in the unit cube, in that order

  [[nodiscard]] SearchView search_view() const { return {data.view(), positions.cview(), order.cview()}; }
};

// As Octree's members of these names.

template <exec::Space Exec>
BuiltOctree build_of_points(Exec& ex, std::span<const Vec3f> positions, const OctreeOptions& options);

template <exec::Space Exec>
std::vector<std::int32_t> point_order(Exec& ex, const BuiltOctree& tree);

template <exec::Space Exec>
OctreeLevel level_of(Exec& ex, const BuiltOctree& tree, int depth);

template <exec::Space Exec>
std::vector<OctreeLeaf> locate_all(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries);

template <exec::Space Exec>
OctreeNeighbours nearest(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries, int k);

template <exec::Space Exec>
OctreeNeighbours within(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries, double radius);

}  // namespace pointskin::octree

namespace pointskin {

class PSK_HIDDEN Octree::Impl {
 public:
  Workspace workspace;
  octree::BuiltOctree tree;
};

}  // namespace pointskin
