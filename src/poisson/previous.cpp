#include "poisson/previous.hpp"

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "poisson/previous_detail.hpp"

namespace pointskin::poisson {
namespace {

/// Finds a brick of one tree in another: up to the root, and down the same way.
struct MatchBrick {
  octree::OctreeView tree, old_tree;
  ArrayView<std::int32_t> bricks;
  PSK_HD void operator()(std::int64_t brick_of_all) const {
    const int depth = tree.level_of(8 * brick_of_all);
    std::int32_t brick = static_cast<std::int32_t>(brick_of_all - tree.levels[depth].first_node / 8);
    std::int8_t way[octree::kMaxDepth + 1];
    for (int d = depth; d > 0; --d) {
      const std::int32_t parent = tree.levels[d].parent[brick];
      way[d] = static_cast<std::int8_t>(parent & 7);
      brick = parent >> 3;
    }
    std::int32_t old = 0;
    for (int d = 1; d <= depth && old >= 0; ++d) {
      old = old_tree.levels[d - 1].child_brick[8 * old + way[d]];
      if (old >= old_tree.levels[d].bricks) old = -1;
    }
    bricks[brick_of_all] = old;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<std::int32_t> match_bricks(Exec& ex, const octree::OctreeView& tree, const octree::OctreeView& old_tree) {
  auto matches = exec::make_buffer<std::int32_t>(ex, tree.nodes / 8);
  for_each(ex, "solve.match", tree.nodes / 8, MatchBrick{tree, old_tree, matches.view()});
  return matches;
}

PSK_INSTANTIATE(match_bricks);

}  // namespace pointskin::poisson
