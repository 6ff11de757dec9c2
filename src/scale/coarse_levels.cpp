#include "scale/coarse_levels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "exec/cpu_primitives.hpp"
#include "field/in_blocks.hpp"
#include "octree/keys.hpp"
#include "poisson/boundary.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/sum_hats.hpp"

namespace pointskin::scale {
namespace {

using octree::OctreeView;
using poisson::CollapsedSample;
using poisson::Facing;

/// Copies values at own nodes of a level.
template <class T>
struct TakeOwn {
  octree::LevelView level;
  OwnNodes nodes;
  ArrayView<const T> from;  // (nodes of the level, width)
  ArrayView<T> to;          // (nodes, width)
  std::int64_t width;

  void operator()(std::int64_t n) const {
    if (!nodes.holds(level.node_key(static_cast<std::int32_t>(n)))) return;
    for (std::int64_t i = 0; i < width; ++i) to[(level.first_node + n) * width + i] = from[n * width + i];
  }
};

}  // namespace

CoarseLevels::CoarseLevels(exec::Cpu& ex, const BlockPlan& plan, const Setup& setup)
    : ex_(ex), plan_(plan), setup_(setup), resolved_(plan.cells().size(), 0) {
  const int below = 3 * (octree::kPointBits - plan.level());
  auto points = exec::make_buffer<std::uint64_t>(ex_, std::ssize(plan.cells()));
  std::transform(plan.cells().begin(), plan.cells().end(), points.data(),
                 [&](std::uint64_t cell) { return cell << below; });
  tree_ = octree::build_octree_below(ex_, points.cview(), plan.level(), plan.bricks(), plan.level());
}

template <class T>
void CoarseLevels::take_own(const BlockRange& own, ArrayView<const T> from, ArrayView<T> to, std::int64_t width) {
  const octree::LevelView level = last_level();
  for_each(ex_, "scale.take", level.nodes(), TakeOwn<T>{level, {plan_.level(), plan_.depth(), own}, from, to, width});
}

template <class T>
void CoarseLevels::join_own(exec::Buffer<T>& nodes, std::int64_t width) {
  const Team& team = setup_.team;
  if (team.is_alone()) return;
  if (nodes.empty()) nodes = exec::make_buffer<T>(ex_, this->nodes() * width);
  const octree::LevelView level = last_level();
  std::vector<std::uint64_t> ends;  // of the cells of each rank, which ascend
  for (int rank = 0; rank < team.size(); ++rank)
    ends.push_back(std::max(ends.empty() ? 0 : ends.back(), plan_.range_of(rank).end));
  const OwnNodes cells{plan_.level(), plan_.depth(), {}};
  const auto for_nodes = [&](const auto& visit) {
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const std::uint64_t cell = cells.first_cell(level.node_key(static_cast<std::int32_t>(n)));
      visit(std::ranges::upper_bound(ends, cell) - ends.begin(), nodes.data() + (level.first_node + n) * width);
    }
  };
  std::vector<T> own;
  for_nodes([&](std::ptrdiff_t rank, const T* values) {
    if (rank == team.rank()) own.insert(own.end(), values, values + width);
  });
  const std::vector<std::vector<T>> all = team.gather(std::move(own));
  std::vector<std::size_t> next(all.size(), 0);
  for_nodes([&](std::ptrdiff_t rank, T* values) {
    const auto r = static_cast<std::size_t>(rank);
    std::copy_n(all[r].data() + next[r], width, values);
    next[r] += static_cast<std::size_t>(width);
  });
}

void CoarseLevels::add_facing(const BlockRange& own, ArrayView<const Facing> facing) {
  if (facing_.empty()) facing_ = exec::make_buffer<Facing>(ex_, nodes());
  take_own<Facing>(own, facing, facing_.view());
}

void CoarseLevels::finish_facing() {
  join_own(facing_);
  const OctreeView view = tree_.view();
  for (int d = plan_.level() - 1; d >= 0; --d) {
    const octree::LevelView& level = view.levels[d];
    const octree::LevelView& below = view.levels[d + 1];
    for_each(ex_, "density.restrict", level.nodes(),
             poisson::hats::Restrict<Facing>{level, below, facing_.data() + below.first_node,
                                             facing_.view().part(level.first_node, level.nodes())});
  }
  if (!setup_.needs_counts) return;
  counts_ = exec::make_buffer<float>(ex_, facing_.size());
  std::transform(facing_.data(), facing_.data() + facing_.size(), counts_.data(),
                 [](const Facing& facing) { return facing.count; });
}

void CoarseLevels::add_depths(const BlockRange& own, int level, ArrayView<const std::uint64_t> bricks,
                              ArrayView<const std::uint32_t> levels) {
  for (std::int64_t brick = 0; brick < bricks.size; ++brick) {
    const std::uint64_t cell = bricks[brick] << 3 * (plan_.depth() - level + 1);
    if (cell >= own.begin && cell < own.end) depths_ |= levels[brick];
  }
}

void CoarseLevels::add_samples(const BlockRange& own, const OwnSamples& samples) {
  if (samples.keys.empty()) return;
  const std::vector<std::uint64_t>& cells = plan_.cells();
  const std::uint64_t first_cell = samples.keys[0] >> 3 * (octree::kPointBits - plan_.level());
  auto cell = static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), first_cell) - cells.begin());
  for (std::int64_t i = 0; i < samples.keys.size; ++i) {
    const float depth = samples.depths[i];
    while (plan_.first()[cell + 1] <= own.samples.begin + i) ++cell;
    std::int8_t& finest = resolved_[cell];
    while (finest < plan_.level() && poisson::resolves(depth, finest + 1)) ++finest;
    if (static_cast<int>(depth) > plan_.level()) continue;
    sparse_.push_back({samples.keys[i], samples.positions[i], samples.normals[i], samples.areas[i], depth});
  }
}

bool CoarseLevels::is_sparse() const { return (depths_ & poisson::kSparseSamples) != 0; }

void CoarseLevels::set_depths(poisson::Samples& samples) const {
  samples.splat_depth_set = depths_ & ~poisson::kSparseSamples;
  samples.coarsest_splat_depth = std::countr_zero(samples.splat_depth_set);
}

void CoarseLevels::join_samples() {
  if (setup_.team.is_alone()) return;
  depths_ = setup_.team.reduce(depths_, std::bit_or<>{});
  const std::vector<std::vector<std::int8_t>> all = setup_.team.gather(resolved_);
  for (const std::vector<std::int8_t>& levels : all)
    for (std::size_t cell = 0; cell < resolved_.size(); ++cell)
      resolved_[cell] = std::max(resolved_[cell], levels[cell]);
  sparse_ = setup_.team.gather_all(std::move(sparse_));
}

void CoarseLevels::splat() {
  join_samples();
  if (is_sparse()) find_resolution();
  splat_sparse();
  b_ = exec::make_buffer<float>(ex_, nodes());
  exec::fill(ex_, b_.view(), 0.0F);
  collapsed_.resize(static_cast<std::size_t>(plan_.level()) + 1);
}

void CoarseLevels::find_resolution() {
  const OctreeView view = tree_.view();
  auto own = exec::make_buffer<std::uint8_t>(ex_, view.nodes / 8);
  exec::fill(ex_, own.view(), std::uint8_t{0});
  for (std::size_t i = 0; i < resolved_.size(); ++i)
    for (int d = octree::kCompleteDepth + 1; d <= resolved_[i]; ++d) {
      const octree::LevelView& level = view.levels[d];
      const std::uint64_t brick = plan_.cells()[i] >> 3 * (plan_.level() - d + 1);
      const std::uint64_t* const found = std::lower_bound(level.brick_key, level.brick_key + level.cell_bricks, brick);
      own.data()[level.first_node / 8 + (found - level.brick_key)] = 1;
    }
  resolved_bricks_ = poisson::resolved_around(ex_, view, own.cview());
}

void CoarseLevels::splat_sparse() {
  const auto n = std::ssize(sparse_);
  poisson::Samples& samples = sparse_samples_;
  samples.positions = exec::make_buffer<Vec3f>(ex_, n);
  samples.normals = exec::make_buffer<Vec3f>(ex_, n);
  samples.areas = exec::make_buffer<float>(ex_, n);
  samples.splat_depths = exec::make_buffer<float>(ex_, n);
  auto keys = exec::make_buffer<std::uint64_t>(ex_, n);
  for (std::int64_t i = 0; i < n; ++i) {
    const SparseSample& from = sparse_[static_cast<std::size_t>(i)];
    keys.data()[i] = from.key;
    samples.positions.data()[i] = from.position;
    samples.normals.data()[i] = from.normal;
    samples.areas.data()[i] = from.area;
    samples.splat_depths.data()[i] = from.depth;
  }
  sparse_ = {};
  set_depths(samples);
  sparse_tree_ = octree::build_octree_below(ex_, keys.cview(), plan_.level(), plan_.bricks(), plan_.level());
  field_ = poisson::splat_coarse_levels(ex_, sparse_tree_.view(), plan_.depth(), samples.view());
}

void CoarseLevels::add_divergence(const BlockRange& own, ArrayView<const float> b) {
  take_own<float>(own, b, b_.view());
}

void CoarseLevels::add_collapsed(const BlockRange& own, int level, ArrayView<const CollapsedSample> cells) {
  const octree::LevelView here = tree_.view().levels[level];
  for (std::int64_t cell = 0; cell < here.cells(); ++cell) {
    const std::uint64_t finest = here.node_key(static_cast<std::int32_t>(cell)) << 3 * (plan_.depth() - level);
    if (here.point_begin[cell] < here.point_begin[cell + 1] && finest >= own.begin && finest < own.end)
      collapsed_[static_cast<std::size_t>(level)].push_back(cells[cell]);
  }
}

void CoarseLevels::add_channels(const BlockRange& own, std::size_t pass, ArrayView<const float> means) {
  channels_.resize(setup_.passes.size());
  const auto width = static_cast<std::int64_t>(1 + setup_.passes[pass]);
  if (channels_[pass].empty()) channels_[pass] = exec::make_buffer<float>(ex_, nodes() * width);
  take_own<float>(own, means, channels_[pass].view(), width);
}

void CoarseLevels::finish_channels() {
  channels_.resize(setup_.passes.size());
  for (std::size_t pass = 0; pass < channels_.size(); ++pass) {
    join_own(channels_[pass], static_cast<std::int64_t>(1 + setup_.passes[pass]));
    field::finish_coarse_channels(ex_, tree_, setup_.passes[pass], channels_[pass].view());
  }
}

void CoarseLevels::join_collapsed() {
  for (std::vector<CollapsedSample>& cells : collapsed_) cells = setup_.team.gather_all(std::move(cells));
}

std::vector<poisson::LevelSolve> CoarseLevels::solve() {
  join_own(b_);
  poisson::Resolution resolution;
  if (is_sparse()) {
    auto bricks = exec::make_buffer<std::uint8_t>(ex_, resolved_bricks_.size());
    copy(ex_, resolved_bricks_.cview(), bricks.view());
    resolution = poisson::resolution_of(ex_, tree_.view(), std::move(bricks));
  }
  poisson::find_coarse_divergence(ex_, sparse_tree_.view(), plan_.depth(), sparse_samples_.view(), resolution,
                                  b_.view());
  sparse_tree_ = {};
  sparse_samples_ = {};
  poisson::Screening screening;
  if (setup_.screening > 0) place_collapsed(screening);
  const OctreeView view = resolution.view(tree_);
  poisson::SolveOptions solving{std::ldexp(setup_.screening, -2 * (plan_.depth() - plan_.level())), setup_.iterations};
  exec::Buffer<std::uint8_t> free;
  if (setup_.boundary == Boundary::dirichlet) free = poisson::free_unknowns(ex_, view, true);
  solving.free_unknowns = free.cview();
  poisson::Solution solution = poisson::solve_poisson(ex_, view, b_.cview(), screening, solving);
  u_ = std::move(solution.u);
  b_.reset();
  return std::move(solution.levels);
}

void CoarseLevels::place_collapsed(poisson::Screening& screening) {
  join_collapsed();
  const OctreeView tree = tree_.view();
  screening = poisson::place_collapsed(ex_, tree_);
  for (int d = plan_.cut_level(); d <= plan_.level(); ++d) {
    const octree::LevelView& level = tree.levels[d];
    const std::vector<CollapsedSample>& collapsed = collapsed_[static_cast<std::size_t>(d)];
    std::size_t next = 0;
    for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
      const std::int32_t place = screening.view(d).brick_index[cell >> 3];
      if (place < 0) continue;
      screening.samples.data()[8 * std::int64_t{place} + (cell & 7)] =
          level.point_begin[cell] < level.point_begin[cell + 1] ? collapsed[next++] : CollapsedSample{};
    }
  }
  poisson::collapse_above(ex_, tree_, plan_.cut_level(), screening);
  collapsed_ = {};
}

}  // namespace pointskin::scale
