#include "poisson/trust.hpp"

#include <algorithm>

#include "exec/this_space.hpp"
#include "poisson/trust_in_cells.hpp"

namespace pointskin::poisson {
namespace {

/// A cell at a time. A GPU has a kernel of its own for it (trust_kernel.cuh).
struct TrustInCell : TrustInCells {
  PSK_HD void operator()(std::int64_t cell) const {
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t end = level.point_begin[cell + 1];
    std::int32_t at = first;
    while (at < end && !is_meant(at)) ++at;
    if (at == end) return;
    const Scatter scatter = scatter_in(first, end);
    for (; at < end; ++at)
      if (is_meant(at)) trust[at] = trust_in(at, scatter);
  }

  [[nodiscard]] PSK_HD Scatter scatter_in(std::int32_t first, std::int32_t end) const {
    Scatter part[kLanes];
    for (std::int32_t i = first; i + 1 < end; ++i) part[(i - first) % kLanes].add(scatter_of(i));
    for (int step = kLanes / 2; step > 0; step /= 2)
      for (int lane = 0; lane < step; ++lane) part[lane].add(part[lane + step]);
    return part[0];
  }
};

template <exec::Space Exec>
requires(!Exec::kOwnKernels) void find_trust(Exec& ex, const TrustInCells& cells) {
  for_each(ex, "screening.trust", cells.level.cells(), TrustInCell{cells});
}

}  // namespace

template <exec::Space Exec>
void weigh_trust(Exec& ex, const octree::OctreeData& tree, Samples& samples) {
  constexpr int kLevelsAbove = 2;  // the cells over which samples are pooled hold 16 of their own on a surface
  constexpr int kDepths = 3;       // sparser samples take the finest of these: a thread should not have too many
  const octree::OctreeView view = tree.view();
  if (samples.trust.empty()) {
    samples.trust = exec::make_buffer<float>(ex, samples.positions.size());
    exec::fill(ex, samples.trust.view(), 1.0F);
  }
  for (int i = 0; i < kDepths && i <= view.depth; ++i) {
    const int depth = view.depth - i;
    const bool last = i == std::min(kDepths - 1, view.depth);
    const std::uint32_t depths = last ? (2U << depth) - 1 : 1U << depth;
    if ((samples.splat_depth_set & depths) == 0) continue;
    const octree::LevelView& level = view.levels[std::max(0, depth - kLevelsAbove)];
    find_trust(ex, TrustInCells{level, depth, last, samples.view(), samples.trust.view()});
  }
}

PSK_INSTANTIATE(weigh_trust);

}  // namespace pointskin::poisson
