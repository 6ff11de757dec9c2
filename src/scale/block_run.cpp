#include "scale/block_run.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "core/format.hpp"
#include "diagnose/in_blocks.hpp"
#include "diagnose/look.hpp"
#include "diagnose/look_at.hpp"
#include "diagnose/spread.hpp"
#include "diagnose/verdict.hpp"
#include "exec/cpu_primitives.hpp"
#include "octree/octree_data.hpp"
#include "poisson/boundary.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/sum_hats.hpp"
#include "poisson/trust.hpp"
#include "reconstruct/pieces_by_support.hpp"
#include "scale/block_cuts.hpp"
#include "scale/block_looks.hpp"
#include "scale/cell_set.hpp"
#include "scale/key_index.hpp"
#include "scale/sample_runs.hpp"
#include "scale/sample_values.hpp"
#include "scale/spool.hpp"
#include "surface/extract.hpp"

namespace pointskin::scale {
namespace {

using octree::OctreeData;
using octree::OctreeView;
using poisson::Facing;
using poisson::Samples;

/// Keys of points have more bits than those of finest cells.
constexpr int shift_to(int depth) { return 3 * (octree::kPointBits - depth); }

/// Makes ascending keys single.
void keep_single(std::vector<std::uint64_t>& keys) { keys.erase(std::unique(keys.begin(), keys.end()), keys.end()); }

/// Bytes that are taken for a node of a block's octree and a sample, while it is solved, and for a node of the coarse levels
/// from the first to the last block (docs/decisions/0057-blocks.md).
constexpr std::int64_t kNodeBytes = 48, kSampleBytes = 60, kCoarseBytes = 83;

/// The coarse levels get a third of the memory.
constexpr std::int64_t kCoarseShare = 3;

/// Cells of the finest level that a block owns, by key, and its own samples.
struct Range {
  std::uint64_t begin = 0, end = 0;
  SampleRun samples;
};

/// The samples of a block and its ring.
struct BlockSamples {
  Samples samples;
  exec::Buffer<std::uint64_t> keys;
  std::int64_t first_own = 0, own = 0;  ///< where its own are
};

/// What all blocks share: levels 0..K.
struct Coarse {
  std::vector<exec::Buffer<std::uint64_t>> bricks;  ///< (K + 1) cell bricks
  OctreeData tree;                                  ///< with a point for every cell of level K that holds samples
  std::vector<std::uint64_t> cells;                 ///< of level K that hold samples, ascending
  std::vector<std::int64_t> first;                  ///< first sample of each, and the number of all

  exec::Buffer<Facing> facing;
  exec::Buffer<float> counts;                  ///< poisson::Density::counts, if they are needed
  std::uint32_t depths = 0;                    ///< that samples are splatted at, with poisson::kSparseSamples
  std::vector<std::int8_t> resolved;           ///< finest level up to K that a sample of each of `cells` resolves
  exec::Buffer<std::uint8_t> resolved_bricks;  ///< Resolution::bricks, or empty if all are
  Samples sparse;                              ///< splatted at levels up to K
  exec::Buffer<std::uint64_t> sparse_keys;
  exec::Buffer<float> field;                                     ///< V of level K, or empty
  exec::Buffer<float> b, u;                                      ///< over the nodes of these levels
  std::vector<std::vector<poisson::CollapsedSample>> collapsed;  ///< (K + 1) of the cells with samples

  [[nodiscard]] std::vector<ArrayView<const std::uint64_t>> brick_views() const {
    std::vector<ArrayView<const std::uint64_t>> views;
    for (const auto& level : bricks) views.push_back(level.cview());
    return views;
  }
  [[nodiscard]] bool is_sparse() const { return (depths & poisson::kSparseSamples) != 0; }
};

/// Copies values at own nodes of a level that has the same numbers in both arrays.
template <class T>
struct TakeOwn {
  octree::LevelView level;
  std::uint64_t begin, end;
  int finer;  // levels from this one to the finest
  ArrayView<const T> from;
  ArrayView<T> to;

  void operator()(std::int64_t n) const {
    if (is_own(level.node_key(static_cast<std::int32_t>(n)))) to[level.first_node + n] = from[level.first_node + n];
  }
  /// Corners on the upper faces of the cube belong to the last cell before them.
  [[nodiscard]] bool is_own(std::uint64_t node) const {
    octree::Coordinates c = octree::decode(node);
    const std::int32_t last = (1 << level.depth) - 1;
    c = {std::min(c.x, last), std::min(c.y, last), std::min(c.z, last)};
    const std::uint64_t cell = octree::encode(c) << 3 * finer;
    return cell >= begin && cell < end;
  }
};

/// Limits what buffers may take together as long as it is there; 0: they may take what they like.
class LimitOfPool {
 public:
  LimitOfPool(exec::Cpu& ex, std::int64_t bytes) : ex_(ex) { ex_.pool()->set_limit(bytes); }
  ~LimitOfPool() { ex_.pool()->set_limit(0); }
  LimitOfPool(const LimitOfPool&) = delete;
  LimitOfPool& operator=(const LimitOfPool&) = delete;

 private:
  exec::Cpu& ex_;
};

class BlockRun {
 public:
  BlockRun(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options, BlockReport& report)
      : ex_(ex),
        cloud_(cloud),
        options_(options),
        report_(report),
        depth_(options.depth),
        lowest_splat_depth_(poisson::coarsest_splat_depth(cloud.size(), options.depth)),
        values_(options.folder, cloud.size()),
        counts_(diagnose::make_counts(ex)) {}

  BlockMeshes run() {
    sweep({"bricks", "octree", 0.05}, [&] { find_bricks(); });
    sweep({"plan", "octree", 0.08}, [&] {
      choose_coarse_level();
      find_cells_near_finer();
      find_cells();
      choose_blocks();
      build_coarse_tree();
    });
    const LimitOfPool limit(ex_, options_.holds_to_memory ? options_.memory_bytes : 0);
    over_blocks({"sums", "splat", 0.1}, [&](const Range& own) { sum_facing(own); });
    finish_facing();
    over_blocks({"weights", "splat", 0.16}, [&](const Range& own) { weigh(own); });
    coarse_.facing.reset();
    sweep({"examine", "splat", 0.22}, [&] { examine(); });
    over_blocks({"depths", "splat", 0.23}, [&](const Range& own) { even_out(own); });
    const KeyIndex index(cloud_, level_, coarse_.cells, coarse_.first);
    sweep({"look at samples", "splat", 0.27}, [&] { look_at_pairs(ex_, cloud_, values_, index, depth_, looks()); });
    sweep({"coarse field", "splat", 0.27}, [&] { finish_resolution(); });
    over_blocks({"splat", "splat", 0.27}, [&](const Range& own) { splat(own); });
    sweep({"coarse solve", "solve", 0.4}, [&] { solve_coarse(); });
    poisson::ValuesOfSamples values;
    std::vector<std::unique_ptr<Spool>> fields;
    over_blocks({"solve", "solve", 0.4}, [&](const Range& own) { fields.push_back(solve(own, values)); });
    if (!values.reliable())
      throw Error(ErrorCode::empty_result, "the field at the points is too far from 1/2 to be summed up in blocks");
    report_.isovalue = values.mean();
    BlockMeshes meshes = extract_all(fields);
    sweep({"look at triangles", "extract", 0.98}, [&] {
      const int far_depth = diagnose::far_depth(diagnose::findings_of(looks()), depth_);
      look_at_triangles(meshes, index, far_depth, looks());
    });
    report_.looks = looks();
    return meshes;
  }

 private:
  [[nodiscard]] std::vector<std::int64_t> columns() const {
    std::vector<std::int64_t> columns{sizeof(Vec3f)};
    if (options_.normals) columns.push_back(sizeof(Vec3f));
    if (options_.density_face > 0) columns.push_back(sizeof(float));
    return columns;
  }

  [[nodiscard]] bool picks_by_support() const {
    return detail::picks_pieces_by_support(options_.largest, options_.min_component);
  }
  [[nodiscard]] double fewest_samples() const {
    if (!picks_by_support()) return 0;
    return detail::fewest_samples(diagnose::findings_of(looks()).lonely > 0, report_.lone_corners);
  }
  [[nodiscard]] bool needs_counts() const { return picks_by_support() || options_.density_face > 0; }

  /// Whether pieces without samples go is known once all is extracted: then once more, with pieces.
  BlockMeshes extract_all(std::vector<std::unique_ptr<Spool>>& fields) {
    surface::PieceOptions pieces{options_.largest, options_.min_component, fewest_samples()};
    const auto looks_for_pieces = [&] { return pieces.largest || pieces.least > 0 || pieces.least_samples > 0; };
    const bool may_come_again = picks_by_support() && !looks_for_pieces();
    BlockMeshes meshes = start_meshes(looks_for_pieces());
    std::size_t block = 0;
    over_blocks({"extract", "extract", 0.8}, [&](const Range& own) {
      extract(own, *fields[block], {pieces.least_samples > 0, true}, meshes);
      if (!may_come_again) fields[block].reset();
      ++block;
    });
    pieces.least_samples = fewest_samples();
    if (may_come_again && looks_for_pieces()) {
      meshes = start_meshes(true);
      block = 0;
      over_blocks({"extract again", "extract", 0.9}, [&](const Range& own) {
        extract(own, *fields[block++], {true, false}, meshes);
      });
    }
    fields.clear();
    sweep({"join", "extract", 0.98}, [&] {
      meshes.finish();
      if (looks_for_pieces() && meshes.triangles() > 0) report_.pieces = meshes.keep_pieces(pieces);
    });
    return meshes;
  }

  [[nodiscard]] BlockMeshes start_meshes(bool pieces) const {
    return BlockMeshes({options_.folder, depth_, level_, columns(), pieces});
  }
  [[nodiscard]] int finer() const { return depth_ - level_; }

  [[nodiscard]] diagnose::Counts& looks() const { return *counts_.data(); }

  /// A pass over all samples or blocks.
  struct Pass {
    const char* name;   ///< in the report
    const char* phase;  ///< as callers of Options::progress know it
    double fraction;    ///< of the run that is done when it begins
  };
  template <class Work>
  void sweep(const Pass& pass, const Work& work) {
    announce(options_.progress, pass.phase, pass.fraction);
    ex_.pool()->trim();  // what another pass left, in other sizes, is no use
    const auto begin = std::chrono::steady_clock::now();
    work();
    report_.sweeps.push_back(
        {pass.name, pass.phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  }
  template <class Work>
  void over_blocks(const Pass& pass, const Work& work) {
    sweep(pass, [&] {
      for (const Range& own : ranges_) {
        announce(options_.progress, pass.phase, pass.fraction);
        work(own);
      }
    });
  }

  /// Calls visit(first, keys) with all keys, part by part.
  template <class Visit>
  void for_keys(const Visit& visit) const {
    std::vector<std::uint64_t> keys;
    for (std::int64_t first = 0; first < cloud_.size(); first += std::ssize(keys)) {
      keys.resize(static_cast<std::size_t>(std::min(options_.part_samples, cloud_.size() - first)));
      cloud_.read(first, std::ssize(keys), {.keys = keys.data()});
      visit(first, keys);
    }
  }

  void find_cells() {
    for_keys([&](std::int64_t first, const std::vector<std::uint64_t>& keys) {
      for (std::size_t i = 0; i < keys.size(); ++i) {
        const std::uint64_t cell = keys[i] >> shift_to(level_);
        if (!coarse_.cells.empty() && coarse_.cells.back() == cell) continue;
        coarse_.cells.push_back(cell);
        coarse_.first.push_back(first + static_cast<std::int64_t>(i));
      }
    });
    coarse_.first.push_back(cloud_.size());
    coarse_.resolved.assign(coarse_.cells.size(), 0);
  }

  /// A cell with children, and how many bricks lie below it.
  struct SplitCell {
    std::uint64_t key = 0;
    std::int64_t bricks = 0;
  };

  /// The cells of level depth - 2 with children. The bricks that parts of the points need are, together, those that all points
  /// need; of those that several parts need, the bricks of the finest level count several times.
  void find_bricks() {
    std::size_t most = std::size_t{1} << 17;
    for_keys([&](std::int64_t /*first*/, std::vector<std::uint64_t> keys) {
      for (std::uint64_t& key : keys) key >>= shift_to(depth_);
      keep_single(keys);
      const ArrayView<const std::uint64_t> cells{keys.data(), std::ssize(keys)};
      const exec::Buffer<std::uint64_t> finest = octree::bricks_around(ex_, cells, depth_);
      const exec::Buffer<std::uint64_t> above = octree::bricks_around(ex_, finest.cview(), depth_ - 1);
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
    for (SplitCell& cell : split_) ++cell.bricks;  // its own children
  }

  void join_split() {
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

  /// Goes up from level depth - 2 to K, and on to the complete levels.
  void choose_coarse_level() {
    const int first = depth_ - 2;
    coarse_.bricks.resize(static_cast<std::size_t>(first) + 1);
    std::vector<std::vector<SplitCell>> split(static_cast<std::size_t>(first) + 1);
    split[static_cast<std::size_t>(first)] = std::move(split_);
    std::vector<std::int64_t> nodes(static_cast<std::size_t>(first) + 1);  // of each level and all above
    for (int d = first; d > octree::kCompleteDepth; --d) {
      const std::vector<SplitCell>& below = split[static_cast<std::size_t>(d)];
      std::vector<std::uint64_t> keys(below.size());
      std::transform(below.begin(), below.end(), keys.begin(), [](const SplitCell& cell) { return cell.key; });
      auto& bricks = coarse_.bricks[static_cast<std::size_t>(d)];
      bricks = octree::bricks_around(ex_, ArrayView<const std::uint64_t>{keys.data(), std::ssize(keys)}, d);
      std::vector<SplitCell>& above = split[static_cast<std::size_t>(d) - 1];
      std::size_t next = 0;
      for (std::int64_t i = 0; i < bricks.size(); ++i) {
        SplitCell cell{bricks.data()[i], 1};
        for (; next < below.size() && below[next].key >> 3 == cell.key; ++next) cell.bricks += below[next].bricks;
        above.push_back(cell);
      }
    }
    for (int d = 0; d <= first; ++d) {
      const std::int64_t own = d <= octree::kCompleteDepth ? (std::int64_t{1} << 3 * d)
                                                           : 8 * coarse_.bricks[static_cast<std::size_t>(d)].size();
      nodes[static_cast<std::size_t>(d)] = own + (d > 0 ? nodes[static_cast<std::size_t>(d) - 1] : 0);
    }
    level_ = options_.coarse_level > 0 ? options_.coarse_level : first;
    if (options_.coarse_level <= 0)
      while (level_ > octree::kCompleteDepth &&
             with_ghosts(nodes[static_cast<std::size_t>(level_)]) * kCoarseBytes > options_.memory_bytes / kCoarseShare)
        --level_;
    coarse_.bricks.resize(static_cast<std::size_t>(level_) + 1);
    split_ = std::move(split[static_cast<std::size_t>(level_)]);
    planned_coarse_bytes_ = with_ghosts(nodes[static_cast<std::size_t>(level_)]) * kCoarseBytes;
    report_.coarse_level = level_;
    cut_level_ = std::max(0, std::min({level_, depth_ - 4, lowest_splat_depth_}));
  }

  /// Upper ends of cells need nodes beside those of the cells' own bricks.
  static std::int64_t with_ghosts(std::int64_t nodes) { return nodes + nodes / 4; }

  /// Cells with children, and all around them.
  void find_cells_near_finer() {
    std::vector<std::uint64_t> keys(split_.size());
    std::transform(split_.begin(), split_.end(), keys.begin(), [](const SplitCell& cell) { return cell.key; });
    near_finer_ = CellSet(level_, keys).grown(1).keys();
  }

  /// As many as are asked for; or the fewest, as far as estimates tell, that memory holds one by one.
  void choose_blocks() {
    if (options_.blocks > 0) return cut(options_.blocks);
    const double left = std::max(1.0, static_cast<double>(options_.memory_bytes - planned_coarse_bytes_));
    std::int64_t bricks = 0;
    for (const SplitCell& cell : split_) bricks += cell.bricks;
    const double whole = 8 * static_cast<double>(with_ghosts(bricks)) * static_cast<double>(kNodeBytes);
    for (int blocks = static_cast<int>(std::clamp(whole / left, 1.0, 1e6));;) {
      cut(blocks);
      std::int64_t most = 0;
      for (const Range& own : ranges_) {
        most = std::max(most, planned_bytes(own));
        if (static_cast<double>(most) > left) break;
      }
      if (planned_coarse_bytes_ + most <= options_.memory_bytes) return;
      if (std::ssize(ranges_) < blocks)
        throw Error(ErrorCode::over_limit,
                    fmt::format("blocks of this cloud need {} bytes or more: one that cannot be cut takes {} with its "
                                "ring, and the levels that all share {}",
                                planned_coarse_bytes_ + most, most, planned_coarse_bytes_));
      blocks = std::max(blocks + 1, static_cast<int>(std::min(4.0, 0.8 * static_cast<double>(most) / left) * blocks));
    }
  }

  /// Of a block with the cells around it, and what working on it takes.
  [[nodiscard]] std::int64_t planned_bytes(const Range& own) const {
    const CellSet cells = around_finer_nodes(own);
    std::int64_t nodes = 0;
    for (const SplitCell& cell : split_)
      if (cells.contains(octree::decode(cell.key))) nodes += 8 * cell.bricks;
    std::int64_t samples = 0;
    for (const SampleRun& run : runs_in(cells, coarse_.cells, coarse_.first)) samples += run.end - run.begin;
    return with_ghosts(nodes) * kNodeBytes + samples * kSampleBytes +
           planned_coarse_bytes_ / kCoarseBytes * kNodeBytes;  // every block's octree has the coarse levels
  }

  /// Sets `ranges_`, at most so many.
  void cut(int blocks) {
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
      const auto cell = std::lower_bound(coarse_.cells.begin(), coarse_.cells.end(), key >> 3 * finer());
      return coarse_.first[static_cast<std::size_t>(cell - coarse_.cells.begin())];
    };
    const std::uint64_t end = std::uint64_t{1} << 3 * depth_;
    ranges_.clear();
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
      if (begins[i] == begins[i + 1]) continue;
      const std::uint64_t begin =
          ranges_.empty() ? 0 : keys[static_cast<std::size_t>(begins[i])] << 3 * (depth_ - cut_level_);
      if (!ranges_.empty()) {
        ranges_.back().end = begin;
        ranges_.back().samples.end = first_in(begin);
      }
      ranges_.push_back({begin, end, {first_in(begin), cloud_.size()}});
    }
  }

  void build_coarse_tree() {
    auto points = exec::make_buffer<std::uint64_t>(ex_, std::ssize(coarse_.cells));
    std::transform(coarse_.cells.begin(), coarse_.cells.end(), points.data(),
                   [&](std::uint64_t cell) { return cell << shift_to(level_); });
    coarse_.tree = octree::build_octree_below(ex_, points.cview(), level_, coarse_.brick_views());
    report_.blocks = static_cast<int>(ranges_.size());
    report_.coarse_nodes = coarse_nodes();
  }

  [[nodiscard]] octree::LevelView coarse_level() const { return coarse_.tree.view().levels[level_]; }

  /// Cells of level K around the block's nodes of that level.
  [[nodiscard]] CellSet around_nodes(const Range& own) const {
    const octree::LevelView level = coarse_level();
    const TakeOwn<char> take{level, own.begin, own.end, finer(), {}, {}};
    std::vector<std::uint64_t> cells;
    const std::int32_t last = (1 << level_) - 1;
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const std::uint64_t node = level.node_key(static_cast<std::int32_t>(n));
      if (!take.is_own(node)) continue;
      const octree::Coordinates c = octree::decode(node);
      cells.push_back(octree::encode({std::min(c.x, last), std::min(c.y, last), std::min(c.z, last)}));
    }
    return CellSet(level_, cells).grown(kSumRing);
  }

  /// Cells of level K around those of the block that hold finer nodes, or touch cells that do: what is extracted from a leaf
  /// needs the nodes on its upper faces, too.
  [[nodiscard]] CellSet around_finer_nodes(const Range& own) const {
    const auto at = [&](std::uint64_t finest) {
      return std::lower_bound(near_finer_.begin(), near_finer_.end(), finest >> 3 * finer());
    };
    return CellSet(level_, std::span(at(own.begin), at(own.end)))
        .grown(options_.ring > 0 ? options_.ring : solve_ring(options_.iterations));
  }

  /// Positions, unit normals and keys of the samples in cells of level K, and columns of values.
  BlockSamples read(const Range& own, const CellSet& cells, bool normals,
                    std::initializer_list<std::pair<SampleValues::Column, exec::Buffer<float> Samples::*>> columns) {
    const std::vector<SampleRun> runs = runs_in(cells, coarse_.cells, coarse_.first);
    std::int64_t n = 0;
    for (const SampleRun& run : runs) n += run.end - run.begin;
    BlockSamples block{{}, exec::make_buffer<std::uint64_t>(ex_, n), 0, own.samples.end - own.samples.begin};
    block.samples.positions = exec::make_buffer<Vec3f>(ex_, n);
    if (normals) block.samples.normals = exec::make_buffer<Vec3f>(ex_, n);
    for (const auto& [column, member] : columns) block.samples.*member = exec::make_buffer<float>(ex_, n);
    std::int64_t at = 0;
    for (const SampleRun& run : runs) {
      const std::int64_t count = run.end - run.begin;
      cloud_.read(run.begin, count,
                  {block.samples.positions.data() + at, normals ? block.samples.normals.data() + at : nullptr,
                   block.keys.data() + at});
      for (const auto& [column, member] : columns)
        values_.read(column, run.begin, (block.samples.*member).view().part(at, count));
      if (run.begin <= own.samples.begin && own.samples.begin < run.end)
        block.first_own = at + own.samples.begin - run.begin;
      at += count;
    }
    poisson::normalise_normals(ex_, block.samples.normals.view());
    report_.most_samples = std::max(report_.most_samples, n);
    report_.samples_read += n;
    return block;
  }

  OctreeData build(BlockSamples& block) {
    OctreeData tree = octree::build_octree_below(ex_, block.keys.cview(), depth_, coarse_.brick_views());
    block.keys.reset();
    report_.most_nodes = std::max(report_.most_nodes, tree.nodes());
    return tree;
  }

  template <class T>
  void take_own(const Range& own, ArrayView<const T> from, ArrayView<T> to) {
    const octree::LevelView level = coarse_level();
    for_each(ex_, "scale.take", level.nodes(), TakeOwn<T>{level, own.begin, own.end, finer(), from, to});
  }

  [[nodiscard]] std::int64_t coarse_nodes() const { return coarse_level().first_node + coarse_level().nodes(); }

  void sum_facing(const Range& own) {
    BlockSamples block = read(own, around_nodes(own), true, {});
    const OctreeData tree = build(block);
    if (coarse_.facing.empty()) coarse_.facing = exec::make_buffer<Facing>(ex_, coarse_nodes());
    const exec::Buffer<Facing> facing = poisson::sum_facing(ex_, tree, block.samples);
    take_own<Facing>(own, facing.cview(), coarse_.facing.view());
  }

  void finish_facing() {
    const OctreeView view = coarse_.tree.view();
    for (int d = level_ - 1; d >= 0; --d) {
      const octree::LevelView& level = view.levels[d];
      const octree::LevelView& below = view.levels[d + 1];
      for_each(ex_, "density.restrict", level.nodes(),
               poisson::hats::Restrict<Facing>{level, below, coarse_.facing.data() + below.first_node,
                                               coarse_.facing.view().part(level.first_node, level.nodes())});
    }
    if (!needs_counts()) return;
    coarse_.counts = exec::make_buffer<float>(ex_, coarse_.facing.size());
    std::transform(coarse_.facing.data(), coarse_.facing.data() + coarse_.facing.size(), coarse_.counts.data(),
                   [](const Facing& facing) { return facing.count; });
  }

  void weigh(const Range& own) {
    BlockSamples block = read(own, around_nodes(own), true, {});
    const OctreeData tree = build(block);
    exec::Buffer<Facing> facing = poisson::sum_facing(ex_, tree, block.samples);
    copy(ex_, coarse_.facing.cview(), facing.view().part(0, coarse_.facing.size()));
    const poisson::Weighed weighed =
        poisson::weigh_by_facing(ex_, tree, options_.samples_per_node, cloud_.size(), facing.cview(), block.samples);
    write_own(own, block, SampleValues::area, block.samples.areas);
    write_own(own, block, SampleValues::depth, block.samples.splat_depths);
    write_own(own, block, SampleValues::own_side, weighed.own_side);
    write_own(own, block, SampleValues::trust, weighed.bends);
    const std::vector<std::int64_t> chosen =
        chosen_own(own, diagnose::kSamples, block.first_own, [](std::int64_t s) { return !diagnose::looks_across(s); });
    diagnose::look_at_densities(ex_, tree.view(), weighed.density,
                                choose(chosen, block.samples.positions.cview()).cview(), counts_);
  }

  /// Where samples of the whole cloud that are looked at, evenly spread, lie among those of a block.
  /// @param first_own  place of the block's first own sample there
  template <class Choose>
  [[nodiscard]] std::vector<std::int64_t> chosen_own(const Range& own, std::int64_t some, std::int64_t first_own,
                                                     const Choose& is_chosen) const {
    const diagnose::Spread spread{std::min(cloud_.size(), some), cloud_.size()};
    std::vector<std::int64_t> chosen;
    for (std::int64_t s = spread.first_from(own.samples.begin); s < spread.some && spread(s) < own.samples.end; ++s)
      if (is_chosen(s)) chosen.push_back(first_own + spread(s) - own.samples.begin);
    return chosen;
  }

  template <class T>
  exec::Buffer<T> choose(const std::vector<std::int64_t>& chosen, ArrayView<const T> from) {
    auto to = exec::make_buffer<T>(ex_, std::ssize(chosen));
    std::transform(chosen.begin(), chosen.end(), to.data(), [&](std::int64_t i) { return from[i]; });
    return to;
  }

  void write_own(const Range& own, const BlockSamples& block, SampleValues::Column column,
                 const exec::Buffer<float>& values) const {
    values_.write(column, own.samples.begin, values.cview().part(block.first_own, block.own));
  }

  /// Calls step(part, samples, own_side) for parts of the samples in their order, with those before and after.
  template <class Step>
  void for_parts(const Step& step) {
    const std::int64_t n = cloud_.size();
    for (std::int64_t first = 0; first < n; first += options_.part_samples) {
      const std::int64_t begin = std::max<std::int64_t>(0, first - poisson::kExamineReach);
      const std::int64_t end = std::min(n, first + options_.part_samples + poisson::kExamineReach);
      const poisson::PartOfCloud part{first, std::min(options_.part_samples, n - first), first - begin, n};
      const auto column = [&](SampleValues::Column which) {
        auto values = exec::make_buffer<float>(ex_, end - begin);
        values_.read(which, begin, values.view());
        return values;
      };
      Samples samples;
      samples.positions = exec::make_buffer<Vec3f>(ex_, end - begin);
      samples.normals = exec::make_buffer<Vec3f>(ex_, end - begin);
      cloud_.read(begin, end - begin, {samples.positions.data(), samples.normals.data()});
      poisson::normalise_normals(ex_, samples.normals.view());
      samples.areas = column(SampleValues::area);
      samples.splat_depths = column(SampleValues::depth);
      step(part, samples, column(SampleValues::own_side));
    }
  }

  void examine() {
    poisson::LookAtCloud look;
    for_parts([&](const poisson::PartOfCloud& part, const Samples& samples, const exec::Buffer<float>& own_side) {
      look.add(poisson::look_at_part(ex_, depth_, part, own_side.cview(), samples));
    });
    for_parts([&](const poisson::PartOfCloud& part, Samples& samples, exec::Buffer<float> own_side) {
      auto bends = exec::make_buffer<float>(ex_, samples.areas.size());
      values_.read(SampleValues::trust, part.first - part.before, bends.view());
      poisson::examine_part(ex_, depth_, lowest_splat_depth_, part, look, std::move(own_side), std::move(bends),
                            samples);
      looks().sums[diagnose::kLonely] += *samples.lonely.data();
      for (std::int64_t i = part.before; i < part.before + part.count; ++i)
        if (samples.areas.data()[i] > 0) report_.inliers.add(samples.positions.data()[i]);
      const auto own = [&](const exec::Buffer<float>& values) { return values.cview().part(part.before, part.count); };
      values_.write(SampleValues::area, part.first, own(samples.areas));
      values_.write(SampleValues::examined_depth, part.first, own(samples.splat_depths));
      values_.write(SampleValues::trust, part.first, own(samples.trust));
    });
  }

  /// Depths become final, and trust.
  void even_out(const Range& own) {
    BlockSamples block = read(own, around_nodes(own), true,
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::examined_depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}});
    std::vector<std::uint64_t> own_keys(block.keys.data() + block.first_own,
                                        block.keys.data() + block.first_own + block.own);
    const OctreeData tree = build(block);
    Samples& samples = block.samples;
    const exec::Buffer<std::uint32_t> levels = poisson::even_out_depths(ex_, tree, samples);
    const octree::LevelView pooled = tree.view().levels[depth_ - 1];
    for (std::int64_t brick = 0; brick < pooled.cell_bricks; ++brick) {
      const std::uint64_t cell = pooled.brick_key[brick] << 6;  // in finest cells
      if (cell >= own.begin && cell < own.end) coarse_.depths |= levels.data()[brick];
    }
    if (options_.screening > 0 && !options_.fixed_screening) poisson::weigh_trust(ex_, tree, samples);
    write_own(own, block, SampleValues::depth, samples.splat_depths);
    write_own(own, block, SampleValues::trust, samples.trust);
    note_sparse(block, own_keys, own);
  }

  /// What the coarse levels need to know of own samples.
  void note_sparse(const BlockSamples& block, const std::vector<std::uint64_t>& keys, const Range& own) {
    std::size_t cell = 0;
    if (block.own > 0)
      cell = static_cast<std::size_t>(
          std::lower_bound(coarse_.cells.begin(), coarse_.cells.end(), keys.front() >> shift_to(level_)) -
          coarse_.cells.begin());
    for (std::int64_t i = 0; i < block.own; ++i) {
      const std::int64_t at = block.first_own + i;
      const float depth = block.samples.splat_depths.data()[at];
      while (coarse_.first[cell + 1] <= own.samples.begin + i) ++cell;
      std::int8_t& finest = coarse_.resolved[cell];
      while (finest < level_ && poisson::resolves(depth, finest + 1)) ++finest;
      if (static_cast<int>(depth) > level_) continue;
      sparse_.push_back({keys[static_cast<std::size_t>(i)], block.samples.positions.data()[at],
                         block.samples.normals.data()[at], block.samples.areas.data()[at], depth});
    }
  }

  [[nodiscard]] std::uint32_t depth_set() const { return coarse_.depths & ~poisson::kSparseSamples; }
  void set_depths(Samples& samples) const {
    samples.splat_depth_set = depth_set();
    samples.coarsest_splat_depth = std::countr_zero(depth_set());
  }

  void finish_resolution() {
    if (coarse_.is_sparse()) {
      const OctreeView view = coarse_.tree.view();
      auto own = exec::make_buffer<std::uint8_t>(ex_, view.nodes / 8);
      exec::fill(ex_, own.view(), std::uint8_t{0});
      for (std::size_t i = 0; i < coarse_.cells.size(); ++i)
        for (int d = octree::kCompleteDepth + 1; d <= coarse_.resolved[i]; ++d) {
          const octree::LevelView& level = view.levels[d];
          const std::uint64_t brick = coarse_.cells[i] >> 3 * (level_ - d + 1);
          const std::uint64_t* const found =
              std::lower_bound(level.brick_key, level.brick_key + level.cell_bricks, brick);
          own.data()[level.first_node / 8 + (found - level.brick_key)] = 1;
        }
      coarse_.resolved_bricks = poisson::resolved_around(ex_, view, own.cview());
    }
    splat_sparse();
    coarse_.b = exec::make_buffer<float>(ex_, coarse_nodes());
    exec::fill(ex_, coarse_.b.view(), 0.0F);
    coarse_.collapsed.resize(static_cast<std::size_t>(level_) + 1);
  }

  void splat_sparse() {
    const auto n = std::ssize(sparse_);
    Samples& samples = coarse_.sparse;
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
    sparse_tree_ = octree::build_octree_below(ex_, keys.cview(), level_, coarse_.brick_views());
    coarse_.field = poisson::splat_coarse_levels(ex_, sparse_tree_.view(), depth_, samples.view());
  }

  /// Samples of a block as the solver needs them.
  BlockSamples read_weighed(const Range& own, const CellSet& cells) {
    BlockSamples block = read(own, cells, true,
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}});
    if (options_.screening <= 0 || options_.fixed_screening) block.samples.trust.reset();
    set_depths(block.samples);
    return block;
  }

  poisson::Resolution resolution_of(const OctreeData& tree, const Samples& samples) {
    if (!coarse_.is_sparse()) return {};
    return poisson::resolution_of(ex_, tree.view(),
                                  poisson::resolved_below(ex_, tree.view(), samples, coarse_.resolved_bricks.cview()));
  }

  /// What a block adds to the systems of levels up to K.
  void splat(const Range& own) {
    BlockSamples block = read_weighed(own, around_nodes(own));
    const OctreeData tree = build(block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    {
      const exec::Buffer<float> b =
          poisson::splat_divergence_below(ex_, tree, block.samples.view(), resolution, level_, coarse_.field.cview());
      take_own<float>(own, b.cview(), coarse_.b.view());
    }
    if (options_.screening <= 0) return;
    const poisson::Screening screening = poisson::collapse_samples(ex_, tree, block.samples.view());
    for (int d = cut_level_; d <= level_; ++d) {
      const octree::LevelView level = tree.view().levels[d];
      const poisson::ScreeningView collapsed = screening.view(d);
      for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
        const std::uint64_t finest = level.node_key(static_cast<std::int32_t>(cell)) << 3 * (depth_ - d);
        if (level.point_begin[cell] == level.point_begin[cell + 1] || finest < own.begin || finest >= own.end) continue;
        coarse_.collapsed[static_cast<std::size_t>(d)].push_back(
            collapsed.samples[8 * std::int64_t{collapsed.brick_index[cell >> 3]} + (cell & 7)]);
      }
    }
  }

  void solve_coarse() {
    poisson::Resolution resolution;
    const OctreeView tree = coarse_.tree.view();
    if (coarse_.is_sparse()) {
      auto bricks = exec::make_buffer<std::uint8_t>(ex_, coarse_.resolved_bricks.size());
      copy(ex_, coarse_.resolved_bricks.cview(), bricks.view());
      resolution = poisson::resolution_of(ex_, tree, std::move(bricks));
    }
    poisson::find_coarse_divergence(ex_, sparse_tree_.view(), depth_, coarse_.sparse.view(), resolution,
                                    coarse_.b.view());
    sparse_tree_ = {};
    coarse_.sparse = {};
    poisson::Screening screening;
    if (options_.screening > 0) {
      screening = poisson::place_collapsed(ex_, coarse_.tree);
      for (int d = cut_level_; d <= level_; ++d) {
        const octree::LevelView& level = tree.levels[d];
        const std::vector<poisson::CollapsedSample>& collapsed = coarse_.collapsed[static_cast<std::size_t>(d)];
        std::size_t next = 0;
        for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
          const std::int32_t place = screening.view(d).brick_index[cell >> 3];
          if (place < 0) continue;
          poisson::CollapsedSample& sample = screening.samples.data()[8 * std::int64_t{place} + (cell & 7)];
          sample =
              level.point_begin[cell] < level.point_begin[cell + 1] ? collapsed[next++] : poisson::CollapsedSample{};
        }
      }
      poisson::collapse_above(ex_, coarse_.tree, cut_level_, screening);
      coarse_.collapsed = {};
    }
    poisson::SolveOptions solving{std::ldexp(options_.screening, -2 * finer()), options_.iterations};
    const exec::Buffer<std::uint8_t> free = find_free_unknowns(resolution.view(coarse_.tree));
    solving.free_unknowns = free.cview();
    poisson::Solution solution =
        poisson::solve_poisson(ex_, resolution.view(coarse_.tree), coarse_.b.cview(), screening, solving);
    coarse_.u = std::move(solution.u);
    for (const poisson::LevelSolve& level : solution.levels)
      report_.levels.push_back({level.depth, tree.levels[level.depth].cells(), 0, level.iterations, 0, 0});
    coarse_.b.reset();
  }

  /// The unknowns to solve for, where some are held at 0; else none.
  exec::Buffer<std::uint8_t> find_free_unknowns(const OctreeView& tree) {
    if (options_.boundary != Boundary::dirichlet) return {};
    return poisson::free_unknowns(ex_, tree, true);
  }

  /// @returns the fields of the finer levels
  std::unique_ptr<Spool> solve(const Range& own, poisson::ValuesOfSamples& values) {
    BlockSamples block = read_weighed(own, around_finer_nodes(own));
    const OctreeData tree = build(block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const exec::Buffer<float> b =
        poisson::splat_divergence_below(ex_, tree, block.samples.view(), resolution, level_, coarse_.field.cview());
    poisson::Screening screening;
    if (options_.screening > 0) screening = poisson::collapse_samples(ex_, tree, block.samples.view());
    const OctreeView view = resolution.view(tree);
    auto u = exec::make_buffer<float>(ex_, view.nodes);
    copy(ex_, coarse_.u.cview(), u.view().part(0, coarse_.u.size()));
    poisson::SolveOptions solving{options_.screening, options_.iterations};
    const exec::Buffer<std::uint8_t> free = find_free_unknowns(view);
    solving.free_unknowns = free.cview();
    report_levels(own, tree.view(), poisson::solve_below(ex_, view, b.cview(), screening, solving, level_, u.view()));
    const poisson::ValuesOfSamples found =
        poisson::values_at_samples(ex_, tree, u.cview(), block.samples.view(), own.begin, own.end);
    values.sum = exec::AddExactly{}(values.sum, found.sum);
    values.count += found.count;
    values.cells += found.cells;
    const std::int64_t bytes = (u.size() - coarse_.u.size()) * std::int64_t{sizeof(float)};
    auto field = std::make_unique<Spool>(options_.folder, bytes);
    field->write(0, u.data() + coarse_.u.size(), bytes);
    return field;
  }

  /// Adds what a block has of its own.
  void report_levels(const Range& own, const OctreeView& tree, const std::vector<poisson::LevelSolve>& solved) {
    for (const poisson::LevelSolve& found : solved) {
      const auto place = static_cast<std::size_t>(found.depth);
      if (report_.levels.size() <= place) report_.levels.push_back({found.depth, 0, 0, found.iterations, 0, 0});
      const octree::LevelView& level = tree.levels[found.depth];
      const auto bricks_before = [&](std::uint64_t cell) {
        return std::lower_bound(level.brick_key, level.brick_key + level.cell_bricks,
                                cell >> 3 * (depth_ - found.depth + 1)) -
               level.brick_key;
      };
      report_.levels[place].nodes += 8 * (bricks_before(own.end) - bricks_before(own.begin));
    }
  }

  /// What an extraction is for besides the surface.
  struct Extraction {
    bool supports = false;  ///< pieces without samples go
    bool looks = false;     ///< counts what may be wrong
  };

  void extract(const Range& own, const Spool& field, const Extraction& what, BlockMeshes& meshes) {
    BlockSamples block = read_weighed(own, around_finer_nodes(own));
    const OctreeData tree = build(block);
    poisson::Density density;
    if (what.supports || options_.density_face > 0) density = density_of(tree, block.samples);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const std::vector<std::int64_t> chosen =
        chosen_own(own, diagnose::kSamples / diagnose::kSparse, block.first_own, [](std::int64_t) { return true; });
    poisson::Samples looked_at;
    looked_at.positions = choose(chosen, block.samples.positions.cview());
    looked_at.splat_depths = choose(chosen, block.samples.splat_depths.cview());
    block = {};
    const OctreeView view = resolution.view(tree);
    auto u = exec::make_buffer<float>(ex_, view.nodes);
    copy(ex_, coarse_.u.cview(), u.view().part(0, coarse_.u.size()));
    field.read(0, u.data() + coarse_.u.size(), field.size());
    surface::SurfacePlaces places;
    surface::ExtractOptions extraction{options_.curvature, options_.normals};
    extraction.places = &places;
    extraction.counted = {own.begin, own.end};
    field::FieldView function{view, u.data(), static_cast<float>(report_.isovalue),
                              options_.domain_faces == DomainFaces::closed,
                              resolution.bricks.empty() ? nullptr : resolution.bricks.data()};
    if (what.looks) diagnose::look_at_field_of_block(ex_, function, looked_at.view(), own.begin, own.end, counts_);
    if (options_.isovalue) function.isovalue = static_cast<float>(*options_.isovalue);
    const surface::Surface surface = surface::extract_surface(ex_, function, extraction);
    if (what.looks) report_.lone_corners += surface.lone_corners;
    exec::Buffer<float> per_cube, per_world;  // samples per area of the cube's unit, and of the world's
    if (what.supports) per_cube = density_at(tree, density, surface, std::ldexp(1.0, -2 * depth_));
    if (options_.density_face > 0) per_world = density_at(tree, density, surface, options_.density_face);
    std::vector<const std::byte*> columns{reinterpret_cast<const std::byte*>(surface.positions.data())};
    if (options_.normals) columns.push_back(reinterpret_cast<const std::byte*>(surface.normals.data()));
    if (options_.density_face > 0) columns.push_back(reinterpret_cast<const std::byte*>(per_world.data()));
    const auto span = [](const auto& buffer) {
      return std::span(buffer.data(), static_cast<std::size_t>(buffer.size()));
    };
    meshes.add({own.begin, own.end, span(places.keys), columns, span(surface.triangles), span(places.cells),
                span(places.segments), span(per_cube)});
  }

  /// As the whole has it, at nodes around which all samples are there.
  poisson::Density density_of(const OctreeData& tree, const Samples& samples) {
    poisson::Density density = poisson::splat_density(ex_, tree, samples.positions.cview());
    copy(ex_, coarse_.counts.cview(), density.counts.view().part(0, coarse_.counts.size()));
    return density;
  }

  /// Samples per area.
  /// @param face  area of a face of a finest cell
  exec::Buffer<float> density_at(const OctreeData& tree, const poisson::Density& density,
                                 const surface::Surface& surface, double face) {
    auto values = exec::make_buffer<float>(ex_, surface.positions.size());
    poisson::evaluate_density(ex_, tree, density, surface.positions.cview(), values.view());
    for_each(ex_, "scale.density", values.size(), poisson::PerArea{face, values.view()});
    return values;
  }

  /// A sample that is splatted at levels up to K.
  struct SparseSample {
    std::uint64_t key = 0;
    Vec3f position, normal;
    float area = 0, depth = 0;
  };

  exec::Cpu& ex_;
  const SortedCloud& cloud_;
  const BlockOptions& options_;
  BlockReport& report_;
  int depth_;
  int level_ = 0;  ///< K
  int lowest_splat_depth_;
  int cut_level_ = 0;                      ///< blocks are cut between its cells
  std::vector<SplitCell> split_;           ///< of level K, ascending
  std::vector<std::uint64_t> near_finer_;  ///< cells of level K that are split or touch one that is, ascending
  std::int64_t planned_coarse_bytes_ = 0;
  SampleValues values_;
  exec::Buffer<diagnose::Counts> counts_;
  Coarse coarse_;
  std::vector<Range> ranges_;
  std::vector<SparseSample> sparse_;
  OctreeData sparse_tree_;
};

}  // namespace

BlockMeshes reconstruct_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                               BlockReport& report) {
  const bool has_levels = options.coarse_level == 0 ||
                          (options.coarse_level >= octree::kCompleteDepth && options.coarse_level <= options.depth - 2);
  const bool plans = options.coarse_level == 0 || options.blocks == 0;
  if (!has_levels || options.depth - 2 < octree::kCompleteDepth || options.blocks < 0 || options.part_samples < 1 ||
      (plans && options.memory_bytes < 1))
    throw Error(ErrorCode::usage,
                fmt::format("a run in blocks needs a depth of at least {}, a coarse level from {} to two "
                            "above the depth, blocks, and parts that hold samples",
                            octree::kCompleteDepth + 2, octree::kCompleteDepth));
  return BlockRun(ex, cloud, options, report).run();
}

}  // namespace pointskin::scale
