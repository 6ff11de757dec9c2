// Nearest point of a cloud to a place, by a tree of boxes.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "mesh/box_tree.hpp"
#include "mesh/nearest.hpp"

namespace pointskin::mesh_detail {

/// The points of a cloud. Memory: 12 bytes a point and those of a BoxTree.
class PointTree {
 public:
  /// @param positions  at least one, at most 2^31 - 1, finite
  /// @param offset     added to every position
  /// O(n log n). Deterministic for any number of threads.
  PointTree(exec::Cpu& ex, const std::vector<Vec3f>& positions, const Vec3d& offset);

  /// The point nearest to `p`, exact in double; of several at the same distance the one with the smallest id.
  /// @param hint  slot of a point that may be near, or -1; changes the time taken, not the answer
  /// About O(log n) for places near the points.
  [[nodiscard]] Nearest nearest(const Vec3d& p, std::int32_t hint = -1) const;

  [[nodiscard]] Vec3d point(std::int32_t slot) const { return offset_ + to_double(positions_.data()[slot]); }
  [[nodiscard]] std::int32_t id(std::int32_t slot) const { return tree_.id(slot); }

 private:
  Vec3d offset_;
  BoxTree tree_;
  exec::Buffer<Vec3f> positions_;  // shape (n), by slot
};

}  // namespace pointskin::mesh_detail
