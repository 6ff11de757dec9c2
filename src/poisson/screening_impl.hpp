#pragma once

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "poisson/screening.hpp"
#include "poisson/splat_kernel.hpp"

namespace pointskin::poisson {
namespace screening {

struct HoldsSamples {
  octree::LevelView level;
  PSK_HD bool operator()(std::int64_t brick) const {
    return level.point_begin[8 * brick] < level.point_begin[8 * brick + 8];
  }
};

struct IndexBricks {
  ArrayView<const std::int32_t> occupied;
  ArrayView<std::int32_t> brick_index;
  PSK_HD void operator()(std::int64_t i) const { brick_index[occupied[i]] = static_cast<std::int32_t>(i); }
};

/// Sums area and area-weighted local position, then divides.
struct Collapse {
  CollapsedSample sum;
  PSK_HD void add(const Vec3f& local, float weight) {
    sum.x += weight * local.x;
    sum.y += weight * local.y;
    sum.z += weight * local.z;
    sum.weight += weight;
  }
  [[nodiscard]] PSK_HD CollapsedSample mean() const {
    if (!(sum.weight > 0)) return {};
    return {sum.x / sum.weight, sum.y / sum.weight, sum.z / sum.weight, sum.weight};
  }
};

/// The cells of an occupied brick, from their samples. A sample sparser than the cells weighs what it weighed at its
/// splat depth: its share of the surface there, not more, or isolated noisy samples would pull bubbles out of the
/// surface.
struct CollapsePoints {
  octree::LevelView level;
  SamplesView samples;
  ArrayView<const std::int32_t> occupied;
  ArrayView<CollapsedSample> out;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t brick = occupied[i];
    const octree::Coordinates origin = brick_origin(level, brick);
    for (int s = 0; s < 8; ++s) {
      const octree::Coordinates cell{origin.x + octree::slot_x(s), origin.y + octree::slot_y(s),
                                     origin.z + octree::slot_z(s)};
      Collapse collapse;
      for (std::int32_t p = level.point_begin[8 * brick + s]; p < level.point_begin[8 * brick + s + 1]; ++p)
        collapse.add(octree::local_in_cell(samples.positions[p], cell, level.depth), weight(p));
      out[8 * i + s] = collapse.mean();
    }
  }

  PSK_HD float weight(std::int32_t p) const {
    const int sparser = level.depth - samples.splat_depths[p];
    return samples.areas[p] / static_cast<float>(sparser > 0 ? std::int64_t{1} << 2 * sparser : 1);
  }
};

/// Coarser cells of an occupied brick, from the cells below.
struct CollapseChildren {
  octree::LevelView level;
  ScreeningView below;
  ArrayView<const std::int32_t> occupied;
  ArrayView<CollapsedSample> out;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t brick = occupied[i];
    for (int s = 0; s < 8; ++s) {
      Collapse collapse;
      const std::int64_t node = 8 * brick + s;
      if (level.point_begin[node] < level.point_begin[node + 1]) {
        const std::int64_t children = 8 * std::int64_t{below.brick_index[level.child_brick[node]]};
        for (int c = 0; c < 8; ++c) {
          const CollapsedSample child = below.samples[children + c];
          collapse.add({0.5F * (static_cast<float>(octree::slot_x(c)) + child.x),
                        0.5F * (static_cast<float>(octree::slot_y(c)) + child.y),
                        0.5F * (static_cast<float>(octree::slot_z(c)) + child.z)},
                       child.weight);
        }
      }
      out[8 * i + s] = collapse.mean();
    }
  }
};

}  // namespace screening

template <exec::Space Exec>
Screening collapse_samples(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples) {
  using namespace screening;
  const octree::OctreeView view = tree.view();
  Screening result;
  result.levels.resize(static_cast<std::size_t>(view.depth) + 1);
  for (int d = view.depth; d >= 0; --d) {
    const octree::LevelView& level = view.levels[d];
    Screening::Level& own = result.levels[static_cast<std::size_t>(d)];
    const exec::Buffer<std::int32_t> occupied =
        select(ex, "screening.occupied", level.cell_bricks, HoldsSamples{level});
    own.brick_index = exec::make_buffer<std::int32_t>(ex, level.bricks);
    exec::fill(ex, own.brick_index.view(), std::int32_t{-1});
    for_each(ex, "screening.index", occupied.size(), IndexBricks{occupied.cview(), own.brick_index.view()});
    own.samples = exec::make_buffer<CollapsedSample>(ex, 8 * occupied.size());
    if (d >= samples.coarsest_splat_depth)
      for_each(ex, "screening.collapse", occupied.size(),
               CollapsePoints{level, samples, occupied.cview(), own.samples.view()});
    else
      for_each(ex, "screening.collapse", occupied.size(),
               CollapseChildren{level, result.view(d + 1), occupied.cview(), own.samples.view()});
  }
  return result;
}

}  // namespace pointskin::poisson
