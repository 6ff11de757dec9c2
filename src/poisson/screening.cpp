#include "poisson/screening.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "octree/placed.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/trust.hpp"

namespace pointskin::poisson {
namespace {

/// 1 for bricks (of all levels) that hold samples.
struct FlagOccupied {
  octree::OctreeView tree;
  ArrayView<std::int32_t> flags;
  PSK_HD void operator()(std::int64_t brick) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick)];
    const std::int64_t own = brick - level.first_node / 8;
    const bool occupied = own < level.cell_bricks && level.point_begin[8 * own] < level.point_begin[8 * own + 8];
    flags[brick] = occupied ? 1 : 0;
  }
};

/// Places of occupied bricks, -1 for others.
struct PlaceBricks {
  ArrayView<const std::int32_t> before;  // (bricks + 1) occupied bricks before each
  ArrayView<std::int32_t> brick_index;
  PSK_HD void operator()(std::int64_t brick) const {
    brick_index[brick] = before[brick] < before[brick + 1] ? before[brick] : -1;
  }
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
  PSK_HD friend Collapse operator+(const Collapse& a, const Collapse& b) {
    return {{a.sum.x + b.sum.x, a.sum.y + b.sum.y, a.sum.z + b.sum.z, a.sum.weight + b.sum.weight}};
  }
  [[nodiscard]] PSK_HD CollapsedSample mean() const {
    if (!(sum.weight > 0)) return {};
    return {sum.x / sum.weight, sum.y / sum.weight, sum.z / sum.weight, sum.weight};
  }
};

/// A cell of an occupied brick, from its samples. Samples sparser than the cells weigh less, by the square of what they
/// can speak for: else each would dent the smooth field around it, and noisy ones would pull bubbles out of the
/// surface.
struct CollapsePoints {
  octree::LevelView level;
  SamplesView samples;
  const std::int32_t* brick_index;
  CollapsedSample* out;
  PSK_HD void operator()(std::int64_t cell) const {
    const std::int32_t place = brick_index[cell >> 3];
    if (place < 0) return;
    const octree::Coordinates at = octree::decode(level.node_key(static_cast<std::int32_t>(cell)));
    Collapse collapse;
    for (std::int32_t p = level.point_begin[cell]; p < level.point_begin[cell + 1]; ++p)
      collapse.add(octree::local_in_cell(samples.positions[p], at, level.depth), weight(p));
    out[8 * std::int64_t{place} + (cell & 7)] = collapse.mean();
  }

  PSK_HD float weight(std::int32_t p) const {
    const float share = sampled_share(samples.splat_depths[p], level.depth);
    const float area = samples.areas[p] * share * share;
    return samples.trust.empty() ? area : trust_at(samples.trust[p], samples.splat_depths[p], level.depth) * area;
  }
};

/// Two levels at once.
struct CollapseTwoLevels {
  CollapsePoints coarser, finer;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t cells = std::int64_t{8} * coarser.level.cell_bricks;
    if (i < cells)
      coarser(i);
    else
      finer(i - cells);
  }
};

/// The same where cells hold many samples: kLanes threads share them.
struct CollapseManyPoints {
  using Sum = Collapse;
  static constexpr int kLanes = 8;
  CollapsePoints cells;

  [[nodiscard]] PSK_HD Collapse part(std::int64_t cell, int lane) const {
    const octree::LevelView& level = cells.level;
    Collapse collapse{};
    if (cells.brick_index[cell >> 3] < 0) return collapse;
    const octree::Coordinates at = octree::decode(level.node_key(static_cast<std::int32_t>(cell)));
    for (std::int32_t p = level.point_begin[cell] + lane; p < level.point_begin[cell + 1]; p += kLanes)
      collapse.add(octree::local_in_cell(cells.samples.positions[p], at, level.depth), cells.weight(p));
    return collapse;
  }
  PSK_HD void finish(std::int64_t cell, const Collapse& collapse) const {
    const std::int32_t place = cells.brick_index[cell >> 3];
    if (place >= 0) cells.out[8 * std::int64_t{place} + (cell & 7)] = collapse.mean();
  }
};

/// A coarser cell of an occupied brick, from the cells below.
struct CollapseChildren {
  octree::LevelView level;
  const std::int32_t* brick_index;
  const std::int32_t* below_brick_index;
  CollapsedSample* samples;
  PSK_HD void operator()(std::int64_t cell) const {
    const std::int32_t place = brick_index[cell >> 3];
    if (place < 0) return;
    Collapse collapse;
    if (level.point_begin[cell] < level.point_begin[cell + 1]) {
      const CollapsedSample* children = samples + 8 * std::int64_t{below_brick_index[level.child_brick[cell]]};
      for (int c = 0; c < 8; ++c) {
        const CollapsedSample child = children[c];
        collapse.add({0.5F * (static_cast<float>(octree::slot_x(c)) + child.x),
                      0.5F * (static_cast<float>(octree::slot_y(c)) + child.y),
                      0.5F * (static_cast<float>(octree::slot_z(c)) + child.z)},
                     child.weight);
      }
    }
    samples[8 * std::int64_t{place} + (cell & 7)] = collapse.mean();
  }
};

/// The complete levels above all splat depths, one a round.
struct CollapseLevels : exec::SweepAll {
  octree::OctreeView tree;
  int first;  // depth of round 0
  std::int32_t* brick_index;
  CollapsedSample* samples;

  [[nodiscard]] PSK_HD int indices(int round) const { return 8 * tree.levels[first - round].cell_bricks; }
  PSK_HD void operator()(int round, int cell, Nothing) const {
    const octree::LevelView& level = tree.levels[first - round];
    const octree::LevelView& below = tree.levels[first - round + 1];
    CollapseChildren{level, brick_index + level.first_node / 8, brick_index + below.first_node / 8, samples}(cell);
  }
};

/// Which corners of a brick (of all levels) the screening touches.
struct MarkCorners {
  octree::OctreeView tree;
  const std::int32_t* brick_index;
  const CollapsedSample* samples;
  ArrayView<std::uint8_t> corners;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick)];
    const std::int64_t first = level.first_node / 8;
    const std::int32_t* bricks = level.neighbours + (brick - first) * octree::kNeighbours;
    // Corners look at cells of their own brick and of those before it.
    unsigned touched = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const int before[3] = {octree::slot_x(s), octree::slot_y(s), octree::slot_z(s)};
      const std::int32_t other = bricks[octree::neighbour_index(-before[0], -before[1], -before[2])];
      const std::int32_t place = other < 0 ? -1 : brick_index[first + other];
      if (place < 0) continue;
      PSK_UNROLL
      for (int cell = 0; cell < 8; ++cell) {
        if ((~cell & s) != 0) continue;  // of a brick before this one, only the cells next to it
        if (samples[8 * std::int64_t{place} + cell].weight > 0) touched |= corners_of(cell, s);
      }
    }
    corners[brick] = static_cast<std::uint8_t>(touched);
  }

  /// Corners of the brick that a cell touches. Along an axis, the last cell of the brick before touches corner 0, cell
  /// 0 both corners, cell 1 corner 1.
  PSK_HD static constexpr unsigned corners_of(int cell, int before) {
    unsigned touched = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int lower = ~corner & 7;                    // axes on which the corner is a lower one
      const bool beyond = (before & ~lower) != 0;       // the brick before does not reach upper corners
      const bool past = (cell & ~before & lower) != 0;  // cell 1 does not reach lower corners
      if (!beyond && !past) touched |= 1U << corner;
    }
    return touched;
  }
};

/// Memory for the samples of occupied bricks, level after level.
/// @param before    shape (bricks + 1), occupied bricks before each
/// @param occupied  its last
template <exec::Space Exec>
exec::Buffer<CollapsedSample> make_collapsed(Exec& ex, const octree::OctreeView& view,
                                             ArrayView<const std::int32_t> before, std::int64_t occupied) {
  std::vector<std::int64_t> borders;
  if (exec::is_shared(ex)) borders.push_back(exec::read_element(ex, before, view.finest().first_node / 8));
  const exec::Placed placed(ex, borders, occupied);
  return exec::make_buffer<CollapsedSample>(ex, 8 * occupied);
}

/// Where each brick's samples are, and memory for them.
template <exec::Space Exec>
void place_samples(Exec& ex, const octree::OctreeView& view, Screening& result) {
  const std::int64_t bricks = view.nodes / 8;
  const auto placed = octree::placed_on_levels(ex, view, view.depth);
  auto flags = exec::make_buffer<std::int32_t>(ex, bricks);
  for_each(ex, "screening.occupied", bricks, FlagOccupied{view, flags.view()});
  auto before = exec::make_buffer<std::int32_t>(ex, bricks + 1);
  exclusive_scan(ex, "screening.occupied", flags.cview(), before.view());
  result.brick_index = std::move(flags);
  std::int32_t occupied = 0;
  copy_to_host_meanwhile(ex, before.cview().part(bricks, 1), &occupied, [&] {
    for_each(ex, "screening.occupied", bricks, PlaceBricks{before.cview(), result.brick_index.view()});
  });
  result.samples = make_collapsed(ex, view, before.cview(), occupied);
}

/// The finest two levels in one launch where points make both.
template <exec::Space Exec>
void collapse_levels(Exec& ex, const octree::OctreeView& view, const SamplesView& samples, Screening& result) {
  const int complete = std::min({view.depth - 1, samples.coarsest_splat_depth - 1, octree::kCompleteDepth});
  const auto collapse_points = [&](int d) {
    return CollapsePoints{view.levels[d], samples, result.view(d).brick_index, result.samples.data()};
  };
  const auto cells_of = [&](int d) { return std::int64_t{8} * view.levels[d].cell_bricks; };
  int d = view.depth;
  if (d > samples.coarsest_splat_depth) {
    const std::int64_t both = cells_of(d - 1) + cells_of(d);
    const exec::Placed placed(ex, {cells_of(d - 1)}, both);
    for_each(ex, "screening.collapse", both, CollapseTwoLevels{collapse_points(d - 1), collapse_points(d)});
    d -= 2;
  } else {
    for_each(ex, "screening.collapse", cells_of(d), collapse_points(d));
    --d;
  }
  for (; d >= samples.coarsest_splat_depth; --d)
    for_each_by_lanes(ex, "screening.collapse", cells_of(d), CollapseManyPoints{collapse_points(d)});
  for (; d > complete; --d)
    for_each(ex, "screening.collapse", cells_of(d),
             CollapseChildren{view.levels[d], result.view(d).brick_index, result.view(d + 1).brick_index,
                              result.samples.data()});
  if (complete >= 0)
    sweep(ex, "screening.collapse", complete + 1, std::int64_t{8} * view.levels[complete].cell_bricks,
          CollapseLevels{{}, view, complete, result.brick_index.data(), result.samples.data()});
}

}  // namespace

template <exec::Space Exec>
Screening collapse_samples(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples) {
  const octree::OctreeView view = tree.view();
  Screening result;
  for (int d = 0; d <= view.depth; ++d) result.first_brick.push_back(view.levels[d].first_node / 8);
  place_samples(ex, view, result);
  collapse_levels(ex, view, samples, result);
  const auto placed = octree::placed_on_levels(ex, view, view.depth);
  result.corners = exec::make_buffer<std::uint8_t>(ex, view.nodes / 8);
  for_each(ex, "screening.corners", view.nodes / 8,
           MarkCorners{view, result.brick_index.data(), result.samples.data(), result.corners.view()});
  return result;
}

template <exec::Space Exec>
Screening place_collapsed(Exec& ex, const octree::OctreeData& tree) {
  const octree::OctreeView view = tree.view();
  Screening result;
  for (int d = 0; d <= view.depth; ++d) result.first_brick.push_back(view.levels[d].first_node / 8);
  place_samples(ex, view, result);
  return result;
}

template <exec::Space Exec>
void collapse_above(Exec& ex, const octree::OctreeData& tree, int level, Screening& screening) {
  const octree::OctreeView view = tree.view();
  for (int d = level - 1; d >= 0; --d)
    for_each(ex, "screening.collapse", std::int64_t{8} * view.levels[d].cell_bricks,
             CollapseChildren{view.levels[d], screening.view(d).brick_index, screening.view(d + 1).brick_index,
                              screening.samples.data()});
  screening.corners = exec::make_buffer<std::uint8_t>(ex, view.nodes / 8);
  for_each(ex, "screening.corners", view.nodes / 8,
           MarkCorners{view, screening.brick_index.data(), screening.samples.data(), screening.corners.view()});
}

PSK_INSTANTIATE(collapse_samples);
PSK_INSTANTIATE(place_collapsed);
PSK_INSTANTIATE(collapse_above);

}  // namespace pointskin::poisson
