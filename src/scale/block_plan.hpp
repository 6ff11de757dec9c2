// How a cloud is divided into blocks: which levels of the octree all share, and which cells each block owns and needs around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "octree/view.hpp"
#include "scale/cell_set.hpp"
#include "scale/sample_runs.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// Cells of level K that a block needs around its own: to know what reaches its nodes of that level, and to solve the finer ones
/// (docs/decisions/0057-blocks.md).
inline constexpr int kSumRing = 5;
/// An iteration reaches a cell of its level: of K's half a one, a quarter, and so on.
/// @param finer_levels  than K
[[nodiscard]] constexpr int solve_ring(int iterations, int finer_levels) {
  return iterations - (iterations >> finer_levels) + 5;
}

/// Cells of the finest level that a block owns, by key, and its own samples.
struct BlockRange {
  std::uint64_t begin = 0, end = 0;
  SampleRun samples;
  std::size_t number = 0;  ///< of the block, from 0 on
};

/// The nodes of a level that a block owns.
struct OwnNodes {
  int level = 0, depth = 0;  ///< of the nodes, and of the finest cells
  BlockRange own;

  /// Corners on the upper faces of the cube belong to the last cell before them.
  [[nodiscard]] bool holds(std::uint64_t node) const {
    const std::uint64_t finest = first_cell(node);
    return finest >= own.begin && finest < own.end;
  }
  /// The first of the finest cells in the cell at a node.
  [[nodiscard]] std::uint64_t first_cell(std::uint64_t node) const { return cell_beside(node) << 3 * (depth - level); }
  /// The cell at a node, or the last one before it.
  [[nodiscard]] std::uint64_t cell_beside(std::uint64_t node) const;
};

class BlockPlan {
 public:
  struct Setup {
    int depth = 0;
    int coarse_level = 0;  ///< BlockOptions has these
    int blocks = 0;
    std::int64_t memory_bytes = 0;
    std::int64_t part_samples = 1;
    int iterations = 8;
    int ring = 0;                    ///< cells around what is solved; 0: solve_ring()
    int lowest_splat_depth = 0;      ///< poisson::coarsest_splat_depth()
    std::int64_t sample_floats = 0;  ///< that samples have for their attributes
    std::int64_t pass_floats = 0;    ///< that nodes have for them in the widest pass
    std::int64_t coarse_floats = 0;  ///< that nodes of the coarse levels have for them in all passes
    std::int64_t vertex_bytes = 0;   ///< that vertices have for them
    Team team{};                     ///< each of its ranks gets as many blocks, where their number is chosen
  };
  BlockPlan(exec::Cpu& ex, const SortedCloud& cloud, const Setup& setup) : ex_(ex), cloud_(cloud), setup_(setup) {}

  /// Counts the bricks that the octree will have, in one pass over the keys. O(n), 16 bytes a cell of level depth - 2 with children.
  /// Collective, as divide()
  void find_bricks();

  /// Chooses K and the blocks, in a second pass, once bricks are known.
  /// @throws Error over_limit if no number of blocks does with the memory, which says how much one that cannot be cut takes
  void divide();

  [[nodiscard]] int level() const { return level_; }  ///< K
  [[nodiscard]] int depth() const { return setup_.depth; }
  /// Blocks are cut between cells of this level.
  [[nodiscard]] int cut_level() const { return cut_level_; }
  [[nodiscard]] const std::vector<BlockRange>& blocks() const { return blocks_; }
  /// All cells and samples of the blocks that a rank works on; none if it has no block.
  [[nodiscard]] BlockRange range_of(int rank) const;

  /// Cells of level K that hold samples, ascending, and (cells + 1) the first sample of each and the number of all.
  [[nodiscard]] const std::vector<std::uint64_t>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<std::int64_t>& first() const { return first_; }

  /// (K + 1) the cell bricks of the levels up to K, ascending.
  [[nodiscard]] std::vector<ArrayView<const std::uint64_t>> bricks() const;

  /// Cells of level K around a block's nodes of that level.
  /// @param coarse  level K
  [[nodiscard]] CellSet around_nodes(const BlockRange& own, const octree::LevelView& coarse) const;

  /// Cells of level K around those of a block that hold finer nodes, or touch cells that do: what is extracted from a leaf needs
  /// the nodes on its upper faces, too.
  [[nodiscard]] CellSet around_finer_nodes(const BlockRange& own) const;

  /// Whether the samples in all cells of level K that are at most ring() cells away from a cell of the block are among these.
  [[nodiscard]] bool has_all_around(const BlockRange& own, std::uint64_t cell) const;

  /// What the blocks have with their rings, as far as it follows from the octree's bricks.
  struct Sizes {
    std::int64_t nodes = 0;          ///< of levels below K in all blocks
    std::int64_t own_nodes = 0;      ///< of the whole octree there
    std::int64_t largest_bytes = 0;  ///< of the coarse levels and the largest block
  };
  /// As planned, once divided. O(blocks cells)
  [[nodiscard]] Sizes sizes() const;
  [[nodiscard]] int ring() const { return setup_.ring > 0 ? setup_.ring : solve_ring(setup_.iterations, finer()); }

  [[nodiscard]] std::vector<SampleRun> samples_in(const CellSet& set) const { return runs_in(set, cells_, first_); }

 private:
  /// A cell with children, and how many bricks lie below it.
  struct SplitCell {
    std::uint64_t key = 0;
    std::int64_t bricks = 0;
  };

  /// Calls visit(first, keys) with the keys of this rank's share, part by part.
  template <class Visit>
  void for_keys(const Visit& visit) const;
  void join_split();
  void choose_coarse_level(int deepest);
  void find_cells();
  void join_cells();
  void find_cells_near_finer();
  std::int64_t choose_blocks();
  [[nodiscard]] int guess_blocks(double left) const;
  void cut(int blocks);
  /// Of a block with the cells around it, and what working on it takes.
  struct Planned {
    std::int64_t nodes = 0, bytes = 0;
  };
  [[nodiscard]] Planned plan_block(const BlockRange& own) const;
  [[nodiscard]] int finer() const { return setup_.depth - level_; }
  [[nodiscard]] std::int64_t node_bytes() const;
  [[nodiscard]] std::int64_t sample_bytes() const;
  [[nodiscard]] std::int64_t coarse_bytes() const;

  exec::Cpu& ex_;
  const SortedCloud& cloud_;
  Setup setup_;
  int level_ = 0;
  int cut_level_ = 0;
  std::vector<exec::Buffer<std::uint64_t>> bricks_;
  std::vector<std::uint64_t> cells_;
  std::vector<std::int64_t> first_;
  std::vector<SplitCell> split_;           ///< of level depth - 2 and then of K, ascending
  std::vector<std::uint64_t> near_finer_;  ///< cells of level K that are split or touch one that is, ascending
  std::int64_t planned_coarse_bytes_ = 0;
  std::vector<BlockRange> blocks_;
};

}  // namespace pointskin::scale
