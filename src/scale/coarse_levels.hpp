// What all blocks of a cloud share: the levels up to K as a whole, and what all samples add to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/reconstruct.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "poisson/own_side.hpp"
#include "poisson/resolution.hpp"
#include "poisson/samples.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "scale/block_plan.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// Each block adds what it finds at its own nodes and cells, in the order of the blocks; then the steps that follow for these levels
/// are done once, by every rank: what the blocks of other ranks have added is joined first. Arrays over nodes have the numbers of
/// these levels in every block's octree.
class CoarseLevels {
 public:
  struct Setup {
    double screening = 2;
    int iterations = 8;
    Boundary boundary = Boundary::free;
    bool needs_counts = false;          ///< keeps the counts of samples for the density
    std::vector<std::size_t> passes{};  ///< channels of attributes that share each pass
    Team team{};
  };

  /// @param plan  divided
  CoarseLevels(exec::Cpu& ex, const BlockPlan& plan, const Setup& setup);

  [[nodiscard]] octree::LevelView last_level() const { return tree_.view().levels[plan_.level()]; }
  [[nodiscard]] std::int64_t nodes() const { return last_level().first_node + last_level().nodes(); }

  /// @param facing  of the last coarse level, poisson::sum_facing() of a block with its ring
  void add_facing(const BlockRange& own, ArrayView<const poisson::Facing> facing);
  /// Sums up the levels above K, once all is added.
  void finish_facing();
  void drop_facing() { facing_.reset(); }

  /// Notes at which levels own samples are splatted.
  /// @param bricks  keys of the cell bricks of a level of the block's octree
  /// @param levels  of that level, from poisson::even_out_depths()
  void add_depths(const BlockRange& own, int level, ArrayView<const std::uint64_t> bricks,
                  ArrayView<const std::uint32_t> levels);

  /// Columns of a block's own samples.
  struct OwnSamples {
    ArrayView<const std::uint64_t> keys;
    ArrayView<const Vec3f> positions, normals;
    ArrayView<const float> areas, depths;
  };
  /// Keeps what of them the levels up to K need.
  void add_samples(const BlockRange& own, const OwnSamples& samples);
  /// When all samples and depths are noted: which bricks are resolved, and the normals that are splatted at these levels.
  void splat();

  /// @param b  divergence of the last coarse level, in a block's octree
  void add_divergence(const BlockRange& own, ArrayView<const float> b);
  /// @param cells  (cells of the level) collapsed samples in a block's octree
  void add_collapsed(const BlockRange& own, int level, ArrayView<const poisson::CollapsedSample> cells);

  /// @param means  of the last coarse level, of a pass of field::channel_means_below() in a block's octree
  void add_channels(const BlockRange& own, std::size_t pass, ArrayView<const float> means);
  /// Values of attributes at the corners of these levels, once all means are added.
  void finish_channels();
  [[nodiscard]] ArrayView<const float> channels(std::size_t pass) const { return channels_[pass].cview(); }

  /// Solves these levels, once all is added.
  std::vector<poisson::LevelSolve> solve();

  [[nodiscard]] ArrayView<const poisson::Facing> facing() const { return facing_.cview(); }
  [[nodiscard]] ArrayView<const float> counts() const { return counts_.cview(); }  ///< poisson::Density::counts
  [[nodiscard]] ArrayView<const float> field() const { return field_.cview(); }    ///< V of level K, or empty
  [[nodiscard]] ArrayView<const float> u() const { return u_.cview(); }
  /// True if the finest level is not resolved everywhere; and Resolution::bricks of these levels.
  [[nodiscard]] bool is_sparse() const;
  [[nodiscard]] ArrayView<const std::uint8_t> resolved_bricks() const { return resolved_bricks_.cview(); }
  /// What samples know of the levels that any are splatted at.
  void set_depths(poisson::Samples& samples) const;
  [[nodiscard]] const octree::OctreeData& tree() const { return tree_; }

 private:
  /// @param width  values a node
  /// Values of the last coarse level, each of the rank that has a node's block. Collective.
  /// @param nodes  (nodes, width) or empty where this rank has no block
  template <class T>
  void join_own(exec::Buffer<T>& nodes, std::int64_t width = 1);
  void join_samples();
  void join_collapsed();

  template <class T>
  void take_own(const BlockRange& own, ArrayView<const T> from, ArrayView<T> to, std::int64_t width = 1);
  void find_resolution();
  void splat_sparse();
  void place_collapsed(poisson::Screening& screening);

  /// A sample that is splatted at these levels.
  struct SparseSample {
    std::uint64_t key = 0;
    Vec3f position, normal;
    float area = 0, depth = 0;
  };

  exec::Cpu& ex_;
  const BlockPlan& plan_;
  Setup setup_;
  octree::OctreeData tree_;  ///< with a point for every cell of level K that holds samples
  exec::Buffer<poisson::Facing> facing_;
  exec::Buffer<float> counts_;
  std::uint32_t depths_ = 0;           ///< that samples are splatted at, with poisson::kSparseSamples
  std::vector<std::int8_t> resolved_;  ///< finest level up to K that a sample of each of the plan's cells resolves
  std::vector<SparseSample> sparse_;
  octree::OctreeData sparse_tree_;
  poisson::Samples sparse_samples_;
  exec::Buffer<std::uint8_t> resolved_bricks_;  ///< or empty if all are
  exec::Buffer<float> field_, b_, u_;
  std::vector<exec::Buffer<float>> channels_;  ///< of each pass: (nodes, 1 + channels), as field/in_blocks.hpp has them
  std::vector<std::vector<poisson::CollapsedSample>> collapsed_;  ///< (K + 1) of the cells with samples
};

}  // namespace pointskin::scale
