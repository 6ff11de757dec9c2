#include "mesh/point_tree.hpp"

namespace pointskin::mesh_detail {

PointTree::PointTree(exec::Cpu& ex, const std::vector<Vec3f>& positions, const Vec3d& offset)
    : offset_(offset),
      tree_(ex, {positions.data(), static_cast<std::int64_t>(positions.size())},
            [&](std::int32_t id, BoxTree::Node& node) {
              include_point(offset + to_double(positions[static_cast<std::size_t>(id)]), node);
            }),
      positions_(ex.pool(), tree_.size()) {
  exec::for_each(ex, "tree", tree_.size(), [&](std::int64_t slot) {
    positions_.data()[slot] = positions[static_cast<std::size_t>(tree_.id(slot))];
  });
}

Nearest PointTree::nearest(const Vec3d& p, std::int32_t hint) const {
  const auto squared_distance_of = [&](std::int32_t slot) { return squared_length(p - point(slot)); };
  return nearest_in(tree_, p, squared_distance_of, hint);
}

}  // namespace pointskin::mesh_detail
