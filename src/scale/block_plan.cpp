#include "scale/block_plan.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/format.hpp"
#include "exec/cpu_primitives.hpp"
#include "octree/keys.hpp"
#include "octree/octree_data.hpp"
#include "scale/block_cuts.hpp"

namespace pointskin::scale {
namespace {

/// Keys of points have more bits than those of finest cells.
constexpr int shift_to(int depth) { return 3 * (octree::kPointBits - depth); }

/// Bytes that are taken for a node of a block's octree and a sample, while it is solved, and for a node of the coarse levels
/// from the first to the last block (docs/decisions/0057-blocks.md).
constexpr std::int64_t kNodeBytes = 48, kSampleBytes = 60, kCoarseBytes = 83;

/// The coarse levels get a third of the memory.
constexpr std::int64_t kCoarseShare = 3;

/// Upper ends of cells need nodes beside those of the cells' own bricks.
std::int64_t with_ghosts(std::int64_t nodes) { return nodes + nodes / 4; }

}  // namespace

std::uint64_t OwnNodes::cell_beside(std::uint64_t node) const {
  const octree::Coordinates c = octree::decode(node);
  const std::int32_t last = (1 << level) - 1;
  return octree::encode({std::min(c.x, last), std::min(c.y, last), std::min(c.z, last)});
}

/// Attributes are there while a block is splatted or extracted, which takes somewhat less than solving it.
std::int64_t BlockPlan::node_bytes() const {
  constexpr std::int64_t kLess = 4, kNodesAVertex = 7;
  const std::int64_t pass = setup_.pass_floats * std::int64_t{sizeof(float)};
  return kNodeBytes + std::max<std::int64_t>(0, pass - kLess) + setup_.vertex_bytes / kNodesAVertex;
}
std::int64_t BlockPlan::sample_bytes() const {
  return kSampleBytes + setup_.sample_floats * std::int64_t{sizeof(float)};
}
std::int64_t BlockPlan::coarse_bytes() const {
  return kCoarseBytes + setup_.coarse_floats * std::int64_t{sizeof(float)};
}

template <class Visit>
void BlockPlan::for_keys(const Visit& visit) const {
  std::vector<std::uint64_t> keys;
  const Team::Share own = setup_.team.share_of(cloud_.size());
  for (std::int64_t first = own.begin; first < own.end; first += std::ssize(keys)) {
    keys.resize(static_cast<std::size_t>(std::min(setup_.part_samples, own.end - first)));
    cloud_.read(ex_, first, std::ssize(keys), {.keys = keys.data()});
    visit(first, keys);
  }
}

/// The cells of level depth - 2 with children. The bricks that parts of the points need are, together, those that all points
/// need; of those that several parts need, the bricks of the finest level count several times.
void BlockPlan::find_bricks() {
  std::size_t most = std::size_t{1} << 17;
  for_keys([&](std::int64_t /*first*/, const std::vector<std::uint64_t>& keys) {
    const auto levels = octree::bricks_of_points(ex_, ArrayView<const std::uint64_t>{keys.data(), std::ssize(keys)},
                                                 setup_.depth, setup_.depth - 2);
    const exec::Buffer<std::uint64_t>& finest = levels[static_cast<std::size_t>(setup_.depth)];
    const exec::Buffer<std::uint64_t>& above = levels[static_cast<std::size_t>(setup_.depth) - 1];
    std::int64_t next = 0;
    for (std::int64_t i = 0; i < above.size(); ++i) {
      SplitCell cell{above.data()[i], 0};
      for (; next < finest.size() && finest.data()[next] >> 3 == cell.key; ++next) ++cell.bricks;
      split_.push_back(cell);
    }
    if (split_.size() < most) return;
    join_split();
    most = 2 * std::max(split_.size(), most / 2);
  });
  join_split();
  if (!setup_.team.is_alone()) {
    split_ = setup_.team.gather_all(std::move(split_));
    join_split();
  }
  for (SplitCell& cell : split_) ++cell.bricks;  // its own children
}

void BlockPlan::join_split() {
  std::sort(split_.begin(), split_.end(), [](const SplitCell& a, const SplitCell& b) { return a.key < b.key; });
  std::size_t joined = 0;
  for (std::size_t i = 0; i < split_.size(); ++i) {
    if (joined > 0 && split_[joined - 1].key == split_[i].key)
      split_[joined - 1].bricks += split_[i].bricks;
    else
      split_[joined++] = split_[i];
  }
  split_.resize(joined);
}

/// With level depth - 3, planning is faster, and every block's octree smaller. With depth - 2, rings are half as wide: where memory
/// holds no block with the wider one, this one may do.
void BlockPlan::divide() {
  const int finest = setup_.depth - 2;
  const std::vector<SplitCell> cells = split_;
  for (int deepest = std::max(octree::kCompleteDepth, finest - 1);; ++deepest) {
    split_ = cells;
    choose_coarse_level(deepest);
    find_cells_near_finer();
    find_cells();
    const std::int64_t largest = choose_blocks();
    if (planned_coarse_bytes_ + largest <= setup_.memory_bytes || setup_.blocks > 0) return;
    if (level_ == deepest && deepest < finest && setup_.coarse_level <= 0) continue;
    throw Error(ErrorCode::over_limit,
                fmt::format("blocks of this cloud need {} bytes or more: one that cannot be cut takes {} with its "
                            "ring, and the levels that all share {}",
                            planned_coarse_bytes_ + largest, largest, planned_coarse_bytes_));
  }
}

std::vector<ArrayView<const std::uint64_t>> BlockPlan::bricks() const {
  std::vector<ArrayView<const std::uint64_t>> views;
  for (const auto& level : bricks_) views.push_back(level.cview());
  return views;
}

/// Goes up from level depth - 2 to K, and on to the complete levels.
void BlockPlan::choose_coarse_level(int deepest) {
  const int first = setup_.depth - 2;
  std::vector<std::vector<SplitCell>> split(static_cast<std::size_t>(first) + 1);
  split[static_cast<std::size_t>(first)] = std::move(split_);
  std::vector<std::int64_t> nodes(static_cast<std::size_t>(first) + 1);  // of each level and all above
  std::vector<std::uint64_t> keys(split[static_cast<std::size_t>(first)].size());
  std::transform(split[static_cast<std::size_t>(first)].begin(), split[static_cast<std::size_t>(first)].end(),
                 keys.begin(), [&](const SplitCell& cell) { return cell.key << shift_to(first); });
  bricks_ = octree::bricks_of_points(ex_, ArrayView<const std::uint64_t>{keys.data(), std::ssize(keys)}, first,
                                     octree::kCompleteDepth);
  for (int d = first; d > octree::kCompleteDepth; --d) {
    const std::vector<SplitCell>& below = split[static_cast<std::size_t>(d)];
    const auto& bricks = bricks_[static_cast<std::size_t>(d)];
    std::vector<SplitCell>& above = split[static_cast<std::size_t>(d) - 1];
    std::size_t next = 0;
    for (std::int64_t i = 0; i < bricks.size(); ++i) {
      SplitCell cell{bricks.data()[i], 1};
      for (; next < below.size() && below[next].key >> 3 == cell.key; ++next) cell.bricks += below[next].bricks;
      above.push_back(cell);
    }
  }
  for (int d = 0; d <= first; ++d) {
    const std::int64_t own =
        d <= octree::kCompleteDepth ? (std::int64_t{1} << 3 * d) : 8 * bricks_[static_cast<std::size_t>(d)].size();
    nodes[static_cast<std::size_t>(d)] = own + (d > 0 ? nodes[static_cast<std::size_t>(d) - 1] : 0);
  }
  level_ = setup_.coarse_level > 0 ? setup_.coarse_level : deepest;
  if (setup_.coarse_level <= 0)
    while (level_ > octree::kCompleteDepth &&
           with_ghosts(nodes[static_cast<std::size_t>(level_)]) * coarse_bytes() > setup_.memory_bytes / kCoarseShare)
      --level_;
  bricks_.resize(static_cast<std::size_t>(level_) + 1);
  split_ = std::move(split[static_cast<std::size_t>(level_)]);
  planned_coarse_bytes_ = with_ghosts(nodes[static_cast<std::size_t>(level_)]) * coarse_bytes();
  cut_level_ = std::max(0, std::min({level_, setup_.depth - 4, setup_.lowest_splat_depth}));
}

void BlockPlan::find_cells() {
  cells_.clear();
  first_.clear();
  for_keys([&](std::int64_t first, const std::vector<std::uint64_t>& keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::uint64_t cell = keys[i] >> shift_to(level_);
      if (!cells_.empty() && cells_.back() == cell) continue;
      cells_.push_back(cell);
      first_.push_back(first + static_cast<std::int64_t>(i));
    }
  });
  join_cells();
  first_.push_back(cloud_.size());
}

/// A cell that ranks share begins in the first one's.
void BlockPlan::join_cells() {
  if (setup_.team.is_alone()) return;
  cells_ = setup_.team.gather_all(std::move(cells_));
  first_ = setup_.team.gather_all(std::move(first_));
  std::size_t joined = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (joined > 0 && cells_[joined - 1] == cells_[i]) continue;
    cells_[joined] = cells_[i];
    first_[joined++] = first_[i];
  }
  cells_.resize(joined);
  first_.resize(joined);
}

/// Cells with children, and all around them.
void BlockPlan::find_cells_near_finer() {
  std::vector<std::uint64_t> keys(split_.size());
  std::transform(split_.begin(), split_.end(), keys.begin(), [](const SplitCell& cell) { return cell.key; });
  near_finer_ = CellSet(level_, keys).grown(1).keys();
}

/// As many as are asked for; or the fewest, as far as estimates tell, that memory holds one by one.
/// @returns bytes of the largest, more than there are if none of them can be cut
std::int64_t BlockPlan::choose_blocks() {
  if (setup_.blocks > 0) {
    cut(setup_.blocks);
    return 0;
  }
  const double left = std::max(1.0, static_cast<double>(setup_.memory_bytes - planned_coarse_bytes_));
  for (int blocks = guess_blocks(left);;) {
    const int ranks = setup_.team.size();
    blocks = (blocks + ranks - 1) / ranks * ranks;
    cut(blocks);
    std::int64_t most = 0;
    std::vector<std::int64_t> bytes;
    for (std::size_t first = 0; first < blocks_.size() && static_cast<double>(most) <= left; first += bytes.size()) {
      constexpr std::size_t kAtOnce = 4;  // most guesses end at the first of them
      bytes.resize(std::min(kAtOnce, blocks_.size() - first));
      for_each_long(ex_, "scale.plan", std::ssize(bytes), [&](std::int64_t i) {
        const auto block = static_cast<std::size_t>(i);
        bytes[block] = plan_block(blocks_[first + block]).bytes;
      });
      most = std::max(most, *std::max_element(bytes.begin(), bytes.end()));
    }
    if (planned_coarse_bytes_ + most <= setup_.memory_bytes || std::ssize(blocks_) < blocks) return most;
    blocks = std::max(blocks + 1, static_cast<int>(std::min(4.0, static_cast<double>(most) / left) * blocks));
  }
}

/// Somewhat too few: for a block that is a square of a surface, with a ring around it.
int BlockPlan::guess_blocks(double left) const {
  constexpr double kTooMuch = 1.1;
  constexpr int kMost = 1'000'000;
  std::int64_t bricks = 0;
  for (const SplitCell& cell : split_) bricks += cell.bricks;
  const double whole = static_cast<double>(8 * with_ghosts(bricks) * node_bytes() + cloud_.size() * sample_bytes());
  const auto coarse = static_cast<double>(planned_coarse_bytes_ / coarse_bytes() * node_bytes());
  const auto bytes_of_one = [&](int blocks) {
    const double side = std::sqrt(static_cast<double>(split_.size()) / blocks);
    const double wider = 1 + (blocks > 1 ? 2 * ring() / side : 0);
    return coarse + std::min(whole, whole / blocks * wider * wider);
  };
  int blocks = 1;
  while (blocks < kMost && bytes_of_one(blocks) > kTooMuch * left && coarse < left) blocks += 1 + blocks / 16;
  return blocks;
}

BlockPlan::Sizes BlockPlan::sizes() const {
  std::vector<Planned> blocks(blocks_.size());
  for_each_long(ex_, "scale.plan", std::ssize(blocks_), [&](std::int64_t i) {
    blocks[static_cast<std::size_t>(i)] = plan_block(blocks_[static_cast<std::size_t>(i)]);
  });
  Sizes sizes;
  for (const SplitCell& cell : split_) sizes.own_nodes += 8 * cell.bricks;
  for (const Planned& block : blocks) {
    sizes.nodes += block.nodes;
    sizes.largest_bytes = std::max(sizes.largest_bytes, block.bytes);
  }
  sizes.largest_bytes += planned_coarse_bytes_;
  return sizes;
}

BlockPlan::Planned BlockPlan::plan_block(const BlockRange& own) const {
  const CellSet cells = around_finer_nodes(own);
  std::int64_t nodes = 0;
  if (!cells.empty()) {
    auto cell = std::ranges::lower_bound(split_, cells.first_key(), {}, &SplitCell::key);
    for (; cell != split_.end() && cell->key <= cells.last_key(); ++cell)
      if (cells.contains(octree::decode(cell->key))) nodes += 8 * cell->bricks;
  }
  std::int64_t samples = 0;
  for (const SampleRun& run : samples_in(cells)) samples += run.end - run.begin;
  return {nodes, with_ghosts(nodes) * node_bytes() + samples * sample_bytes() +
                     planned_coarse_bytes_ / coarse_bytes() * node_bytes()};  // every octree has the coarse levels
}

/// At most so many.
void BlockPlan::cut(int blocks) {
  std::vector<std::uint64_t> keys;
  std::vector<std::int64_t> loads;
  for (const SplitCell& cell : split_) {
    const std::uint64_t key = cell.key >> 3 * (level_ - cut_level_);
    if (keys.empty() || keys.back() != key) {
      keys.push_back(key);
      loads.push_back(0);
    }
    loads.back() += cell.bricks;
  }
  const std::vector<std::int64_t> begins = cut_evenly(loads, blocks);
  const auto first_in = [&](std::uint64_t key) {  // sample
    const auto cell = std::lower_bound(cells_.begin(), cells_.end(), key >> 3 * finer());
    return first_[static_cast<std::size_t>(cell - cells_.begin())];
  };
  const std::uint64_t end = std::uint64_t{1} << 3 * setup_.depth;
  blocks_.clear();
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    if (begins[i] == begins[i + 1]) continue;
    const std::uint64_t begin =
        blocks_.empty() ? 0 : keys[static_cast<std::size_t>(begins[i])] << 3 * (setup_.depth - cut_level_);
    if (!blocks_.empty()) {
      blocks_.back().end = begin;
      blocks_.back().samples.end = first_in(begin);
    }
    blocks_.push_back({begin, end, {first_in(begin), cloud_.size()}, blocks_.size()});
  }
}

BlockRange BlockPlan::range_of(int rank) const {
  const Team::Share share = setup_.team.share_of(std::ssize(blocks_), rank);
  if (share.begin == share.end) return {};
  const BlockRange& first = blocks_[static_cast<std::size_t>(share.begin)];
  const BlockRange& last = blocks_[static_cast<std::size_t>(share.end) - 1];
  return {first.begin, last.end, {first.samples.begin, last.samples.end}, first.number};
}

CellSet BlockPlan::around_nodes(const BlockRange& own, const octree::LevelView& coarse) const {
  const OwnNodes nodes{level_, setup_.depth, own};
  std::vector<std::uint64_t> cells;
  for (std::int64_t n = 0; n < coarse.nodes(); ++n) {
    const std::uint64_t node = coarse.node_key(static_cast<std::int32_t>(n));
    if (nodes.holds(node)) cells.push_back(nodes.cell_beside(node));
  }
  return CellSet(level_, cells).grown(kSumRing);
}

bool BlockPlan::has_all_around(const BlockRange& own, std::uint64_t cell) const {
  return cell >= own.begin >> 3 * finer() && cell < own.end >> 3 * finer() &&
         std::ranges::binary_search(near_finer_, cell);
}

CellSet BlockPlan::around_finer_nodes(const BlockRange& own) const {
  const auto at = [&](std::uint64_t finest) {
    return std::lower_bound(near_finer_.begin(), near_finer_.end(), finest >> 3 * finer());
  };
  return CellSet(level_, std::span(at(own.begin), at(own.end))).grown(ring());
}

}  // namespace pointskin::scale
