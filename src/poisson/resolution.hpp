// Which cells the samples resolve. Where they are too sparse for a level, its cells add nothing but the noise of where
// the samples happen to lie: the solve leaves the interpolated values there, and the cells above are the leaves.
// Source: PoissonRecon, whose octree keeps only nodes that a splatted normal reaches. Differs: the octree stays, so
// that the density may come after it, and bricks are marked.
#pragma once

#include <cstdint>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// A level is resolved where samples can speak for this share of its cells' faces (sampled_share). Measured in
/// docs/decisions/0018-sparse-samples.md.
inline constexpr float kResolvedShare = 0.42F;

/// True if a sample of this splat depth resolves level `depth`.
PSK_HD inline bool resolves(float splat_depth, int depth) {
  return sampled_share(splat_depth, depth) >= kResolvedShare;
}

/// Which bricks of all levels are resolved. Empty: all are.
struct Resolution {
  exec::Buffer<std::uint8_t> bricks;    ///< (bricks of all levels) 1: the brick's cells count; 0: those above do
  exec::Buffer<std::uint8_t> unknowns;  ///< (bricks of all levels) as LevelView's, of the cells that count

  /// (bricks of the level) or null.
  [[nodiscard]] const std::uint8_t* counts(const octree::LevelView& level) const {
    return bricks.empty() ? nullptr : bricks.data() + level.first_node / 8;
  }

  /// The octree with the unknowns of the cells that count.
  [[nodiscard]] octree::OctreeView view(const octree::OctreeData& tree) const {
    octree::OctreeView view = tree.view();
    for (int d = 0; d <= view.depth && !unknowns.empty(); ++d)
      view.levels[d].unknowns = unknowns.data() + view.levels[d].first_node / 8;
    return view;
  }
};

/// Evens out `samples.splat_depths`, and fills what is known of all of them.
/// A sample's splat depth becomes the mean over the samples in the 27 bricks of level D - 1 around its own, so that the
/// noise of the density does not tear the resolution into patches; at most D; and a level that it does not resolve
/// gets no share of its normal. Means are of integers: they do not depend on the order.
///
/// Marks a brick if a sample in the 27 bricks around it resolves the brick's level, and all bricks of complete levels.
/// So the cells that count are an octree again, and graded: a marked brick is within one cell of the level above of a
/// sample that resolves that level too, and so are the bricks around its parent's.
/// O(n + 27 bricks), six launches and a read-back; three launches less if all samples resolve the finest level.
/// Deterministic, the same bits on every device.
template <exec::Space Exec>
Resolution find_resolution(Exec& ex, const octree::OctreeData& tree, Samples& samples);

}  // namespace pointskin::poisson
