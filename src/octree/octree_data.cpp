#include "octree/octree_data.hpp"

namespace pointskin::octree {

OctreeView OctreeData::view() const {
  OctreeView tree;
  tree.depth = depth;
  for (int d = 0; d <= depth; ++d) {
    const LevelData& data = levels[static_cast<std::size_t>(d)];
    tree.levels[d] = {d,
                      data.cell_bricks,
                      data.bricks,
                      data.near_ghosts,
                      tree.nodes,
                      data.brick_key.data(),
                      data.parent.data(),
                      data.neighbours.data(),
                      data.child_brick.data(),
                      data.unknowns.data(),
                      data.point_begin.data()};
    tree.nodes += tree.levels[d].nodes();
  }
  return tree;
}

std::int64_t OctreeData::nodes() const { return view().nodes; }

std::int64_t OctreeData::cells() const {
  std::int64_t sum = 0;
  const OctreeView tree = view();
  for (int d = 0; d <= depth; ++d) sum += tree.levels[d].cells();
  return sum;
}

}  // namespace pointskin::octree
