#include "poisson/resolution.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "exec/this_space.hpp"
#include "octree/placed.hpp"
#include "poisson/in_blocks.hpp"

namespace pointskin::poisson {
namespace {

/// Sum of the splat depths in each brick of a level.
struct SumDepths {
  static constexpr float kUnit = 65536;  // parts of a level

  octree::LevelView level;
  ArrayView<const float> splat_depths;
  ArrayView<std::int64_t> sums;
  PSK_HD void operator()(std::int64_t brick) const {
    const std::int32_t end = level.point_begin[8 * brick + 8];
    std::int64_t sum = 0;
    for (std::int32_t i = level.point_begin[8 * brick]; i < end; ++i)
      sum += static_cast<std::int64_t>(splat_depths[i] * kUnit);
    sums[brick] = sum;
  }
};

/// Gives the samples of a brick the mean over the 27 bricks around it, cut to what can be splatted.
struct EvenOut {
  static constexpr std::uint32_t kSparse = 1U << 31;

  octree::LevelView level;
  ArrayView<const std::int64_t> sums;
  int finest;
  ArrayView<float> splat_depths;
  ArrayView<std::uint32_t> levels;  // bit d: normals are splatted at level d; kSparse: the finest is not resolved

  PSK_HD void operator()(std::int64_t brick) const {
    const std::int32_t first = level.point_begin[8 * brick];
    const std::int32_t end = level.point_begin[8 * brick + 8];
    levels[brick] = 0;
    if (first == end) return;
    const float depth = splattable(mean_around(brick));
    levels[brick] = 1U << static_cast<int>(depth) | 1U << finer_level(depth) | (resolves(depth, finest) ? 0 : kSparse);
    for (std::int32_t i = first; i < end; ++i) splat_depths[i] = depth;
  }

  [[nodiscard]] PSK_HD float mean_around(std::int64_t brick) const {
    std::int64_t sum = 0;
    std::int64_t count = 0;
    for (int j = 0; j < octree::kNeighbours; ++j) {
      const std::int64_t other = level.neighbours[brick * octree::kNeighbours + j];
      if (other < 0 || other >= level.cell_bricks) continue;
      sum += sums[other];
      count += level.point_begin[8 * other + 8] - level.point_begin[8 * other];
    }
    return static_cast<float>(static_cast<double>(sum) /
                              (static_cast<double>(SumDepths::kUnit) * static_cast<double>(count)));
  }

  [[nodiscard]] PSK_HD float splattable(float depth) const {
    if (depth >= static_cast<float>(finest)) return static_cast<float>(finest);
    const int finer = finer_level(depth);
    return resolves(depth, finer) ? depth : static_cast<float>(finer - 1);
  }
};

struct Union {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const { return a | b; }
};

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
      if (resolves(splat_depths[i], level.depth)) return true;
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
      const std::int32_t other =
          level.neighbours[(brick - first) * octree::kNeighbours +
                           octree::neighbour_index(-octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s))];
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

}  // namespace

template <exec::Space Exec>
Resolution find_resolution(Exec& ex, const octree::OctreeData& tree, Samples& samples) {
  constexpr const char* kLabel = "splat.resolution";
  const octree::OctreeView view = tree.view();
  const octree::LevelView& pooled = view.levels[std::max(0, view.depth - 1)];
  auto sums = exec::make_buffer<std::int64_t>(ex, pooled.cell_bricks);
  for_each(ex, kLabel, sums.size(), SumDepths{pooled, samples.splat_depths.cview(), sums.view()});
  auto levels = exec::make_buffer<std::uint32_t>(ex, sums.size());
  for_each(ex, kLabel, sums.size(),
           EvenOut{pooled, sums.cview(), view.depth, samples.splat_depths.view(), levels.view()});
  const auto found =
      exec::reduce<std::uint32_t>(ex, kLabel, levels.size(), exec::LoadValue<std::uint32_t>{levels.cview()}, Union{});
  samples.splat_depth_set = found & ~EvenOut::kSparse;
  samples.coarsest_splat_depth = std::countr_zero(samples.splat_depth_set);
  sums.reset();
  levels.reset();
  Resolution result;
  if ((found & EvenOut::kSparse) == 0) return result;

  const std::int64_t bricks = view.nodes / 8;
  const auto placed = octree::placed_on_levels(ex, view, view.depth);
  auto own = exec::make_buffer<std::uint8_t>(ex, bricks);
  for_each(ex, kLabel, bricks, FlagOwn{view, samples.splat_depths.cview(), own.view()});
  result.bricks = exec::make_buffer<std::uint8_t>(ex, bricks);
  for_each(ex, kLabel, bricks, FlagAround{view, own.cview(), result.bricks.view()});
  result.unknowns = std::move(own);
  for_each(ex, kLabel, bricks, MarkUnknowns{view, result.bricks.cview(), result.unknowns.view()});
  return result;
}

template <exec::Space Exec>
exec::Buffer<std::uint32_t> even_out_depths(Exec& ex, const octree::OctreeData& tree, Samples& samples) {
  static_assert(kSparseSamples == EvenOut::kSparse);
  const octree::OctreeView view = tree.view();
  const octree::LevelView& pooled = view.levels[std::max(0, view.depth - 1)];
  auto sums = exec::make_buffer<std::int64_t>(ex, pooled.cell_bricks);
  for_each(ex, "splat.resolution", sums.size(), SumDepths{pooled, samples.splat_depths.cview(), sums.view()});
  auto levels = exec::make_buffer<std::uint32_t>(ex, sums.size());
  for_each(ex, "splat.resolution", sums.size(),
           EvenOut{pooled, sums.cview(), view.depth, samples.splat_depths.view(), levels.view()});
  return levels;
}

template <exec::Space Exec>
exec::Buffer<std::uint8_t> resolved_around(Exec& ex, const octree::OctreeView& tree,
                                           ArrayView<const std::uint8_t> own) {
  auto bricks = exec::make_buffer<std::uint8_t>(ex, own.size);
  for_each(ex, "splat.resolution", own.size, FlagAround{tree, own, bricks.view()});
  return bricks;
}

template <exec::Space Exec>
exec::Buffer<std::uint8_t> resolved_below(Exec& ex, const octree::OctreeView& tree, const Samples& samples,
                                          ArrayView<const std::uint8_t> given) {
  auto own = exec::make_buffer<std::uint8_t>(ex, tree.nodes / 8);
  for_each(ex, "splat.resolution", own.size(), FlagOwn{tree, samples.splat_depths.cview(), own.view()});
  exec::Buffer<std::uint8_t> bricks = resolved_around(ex, tree, own.cview());
  copy(ex, given, bricks.view().part(0, given.size));
  return bricks;
}

template <exec::Space Exec>
Resolution resolution_of(Exec& ex, const octree::OctreeView& tree, exec::Buffer<std::uint8_t> bricks) {
  Resolution result{std::move(bricks), exec::make_buffer<std::uint8_t>(ex, tree.nodes / 8)};
  for_each(ex, "splat.resolution", result.unknowns.size(),
           MarkUnknowns{tree, result.bricks.cview(), result.unknowns.view()});
  return result;
}

PSK_INSTANTIATE(find_resolution);
PSK_INSTANTIATE(even_out_depths);
PSK_INSTANTIATE(resolved_around);
PSK_INSTANTIATE(resolved_below);
PSK_INSTANTIATE(resolution_of);

}  // namespace pointskin::poisson
