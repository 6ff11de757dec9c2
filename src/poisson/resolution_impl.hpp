#pragma once

#include "exec/algorithms.hpp"
#include "poisson/resolution.hpp"

namespace pointskin::poisson {
namespace resolution {

/// 1 for cell bricks (of all levels) with a sample that resolves their level.
struct FlagOwn {
  octree::OctreeView tree;
  ArrayView<const float> splat_depths;
  ArrayView<std::uint8_t> own;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick)];
    own[brick] = static_cast<std::uint8_t>(is_resolved(level, brick - level.first_node / 8));
  }

  [[nodiscard]] PSK_HD bool is_resolved(const octree::LevelView& level, std::int64_t brick) const {
    if (brick >= level.cell_bricks) return false;
    const std::int32_t end = level.point_begin[8 * brick + 8];
    for (std::int32_t i = level.point_begin[8 * brick]; i < end; ++i)
      if (sampled_share(splat_depths[i], level.depth) >= kResolvedShare) return true;
    return false;
  }
};

/// 1 for bricks that are resolved by a sample around them.
struct FlagAround {
  octree::OctreeView tree;
  ArrayView<const std::uint8_t> own;
  ArrayView<std::uint8_t> bricks;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick)];
    const std::int64_t first = level.first_node / 8;
    bool resolved = level.depth <= octree::kCompleteDepth || own[brick] != 0;
    for (int j = 0; j < octree::kNeighbours && !resolved; ++j) {
      const std::int32_t other = level.neighbours[(brick - first) * octree::kNeighbours + j];
      resolved = other >= 0 && own[first + other] != 0;
    }
    bricks[brick] = static_cast<std::uint8_t>(resolved);
  }
};

/// Corners of a brick with all their cells, and all these in resolved bricks.
struct MarkUnknowns {
  octree::OctreeView tree;
  ArrayView<const std::uint8_t> bricks;
  ArrayView<std::uint8_t> unknowns;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick)];
    const std::int64_t first = level.first_node / 8;
    unsigned left = level.unknowns[brick - first];
    for (int s = 0; s < 8 && left != 0; ++s) {
      const std::int32_t other = level.neighbours[(brick - first) * octree::kNeighbours +
                                                  octree::neighbour_index(-octree::slot_x(s), -octree::slot_y(s),
                                                                          -octree::slot_z(s))];
      if (other >= 0 && bricks[first + other] == 0) left &= ~corners_at(s);
    }
    unknowns[brick] = static_cast<std::uint8_t>(left);
  }

  /// Corners that the brick before along the axes of `before` touches: the lower ones along these axes.
  PSK_HD static constexpr unsigned corners_at(int before) {
    unsigned corners = 0;
    for (int corner = 0; corner < 8; ++corner)
      if ((corner & before) == 0) corners |= 1U << corner;
    return corners;
  }
};

}  // namespace resolution

template <exec::Space Exec>
Resolution find_resolution(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples) {
  Resolution result;
  if (samples.resolve_all) return result;
  const octree::OctreeView view = tree.view();
  const std::int64_t bricks = view.nodes / 8;
  auto own = exec::make_buffer<std::uint8_t>(ex, bricks);
  for_each(ex, "splat.resolution", bricks, resolution::FlagOwn{view, samples.splat_depths, own.view()});
  result.bricks = exec::make_buffer<std::uint8_t>(ex, bricks);
  for_each(ex, "splat.resolution", bricks, resolution::FlagAround{view, own.cview(), result.bricks.view()});
  result.unknowns = std::move(own);
  for_each(ex, "splat.resolution", bricks,
           resolution::MarkUnknowns{view, result.bricks.cview(), result.unknowns.view()});
  return result;
}

}  // namespace pointskin::poisson
