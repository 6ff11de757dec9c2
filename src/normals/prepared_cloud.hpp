// A cloud as the estimate of its normals sees it: sorted in an octree.
#pragma once

#include <pointskin/cloud.hpp>

#include <cstdint>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::normals {

/// Points in the order of their keys.
struct PreparedCloud {
  octree::Frame frame;
  octree::OctreeData tree;
  exec::Buffer<std::int32_t> order;  ///< (n) index in the cloud
  exec::Buffer<Vec3f> positions;     ///< (n) in the unit cube; strays at its faces
  exec::Buffer<Vec3f> given;         ///< (n) normals of the cloud; empty: it has none
  std::int64_t strays = 0;
};

/// @throws Error invalid_input, empty_result, over_limit
template <exec::Space Exec>
PreparedCloud prepare_cloud(Exec& ex, const Cloud& cloud);

}  // namespace pointskin::normals
