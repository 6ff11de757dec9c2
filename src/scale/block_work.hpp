// What is done with one block after another, in the space that works on them: its samples, and those of the cells around it, come
// from the disk, an octree is made of them, and what the block finds of its own goes to the disk or to the coarse levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "diagnose/counts.hpp"
#include "exec/cpu.hpp"
#include "exec/space.hpp"
#include "poisson/in_blocks.hpp"
#include "scale/block_meshes.hpp"
#include "scale/block_plan.hpp"
#include "scale/block_run.hpp"
#include "scale/coarse_levels.hpp"
#include "scale/sample_values.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/spool.hpp"

namespace pointskin::scale {

/// The columns of the mesh of a run: positions, what was asked for, and what a cut needs.
struct MeshColumns {
  static constexpr std::size_t kNone = 0;  // where positions are
  std::vector<std::int64_t> bytes{sizeof(Vec3f)};
  std::size_t normals = kNone, density = kNone;
  std::size_t attributes = kNone;  ///< the first of those of the cloud, one after another
  std::size_t spacing = kNone;     ///< of samples, where the surface is cut
  std::size_t supports = kNone;    ///< density in the cube's units, for the pieces of what is left
};

/// What all blocks of a run share, in the host's memory and on the disk.
struct SharedOfBlocks {
  exec::Cpu& host;
  const SortedCloud& cloud;
  const BlockOptions& options;
  BlockReport& report;
  BlockPlan plan;
  SampleValues values;
  std::vector<std::size_t> passes{};  ///< channels of attributes that share each pass, in the order of the cloud's
  double mean_length = 0;             ///< of normals as they were given, with BlockOptions::confidence once it is known
  std::optional<CoarseLevels> coarse{};  ///< once blocks are planned
  MeshColumns columns{};                 ///< once it is known whether to cut
};

/// Steps of a run in the order in which they are called, each for every block. Every one builds the block's octree.
/// @throws Error over_limit if the space has no memory left; as SortedCloud::read, Spool
class BlockWork {
 public:
  BlockWork() = default;
  virtual ~BlockWork() = default;
  BlockWork(const BlockWork&) = delete;
  BlockWork& operator=(const BlockWork&) = delete;

  [[nodiscard]] virtual exec::MemoryPool& pool() = 0;

  /// Adds up normals for the coarse levels.
  virtual void sum_facing(const BlockRange& own) = 0;
  /// Areas and depths of the samples, and on which side they lie.
  virtual void weigh(const BlockRange& own) = 0;
  /// Depths become final, and trust.
  virtual void even_out(const BlockRange& own) = 0;
  /// What a block adds to the systems of the coarse levels.
  virtual void splat(const BlockRange& own) = 0;
  /// @returns the fields of the finer levels
  virtual std::unique_ptr<Spool> solve(const BlockRange& own, poisson::ValuesOfSamples& values) = 0;
  /// What solve() adds up, in another unit.
  virtual poisson::ValuesOfSamples sum_values(const BlockRange& own, const Spool& field, int fraction) = 0;

  /// What an extraction is for besides the surface.
  struct Extraction {
    bool supports = false;  ///< pieces without samples go
    bool looks = false;     ///< counts what may be wrong
    DomainFaces faces = DomainFaces::closed;
  };
  virtual void extract(const BlockRange& own, const Spool& field, const Extraction& what, BlockMeshes& meshes) = 0;

  /// Values at some points.
  struct PointValues {
    std::vector<std::vector<float>> densities;       ///< (faces, points) samples per area
    std::vector<std::vector<std::byte>> attributes;  ///< (attributes, points) in their types
  };
  /// At points in the block's own cells.
  /// @param faces  areas of a face of a finest cell, in one unit after another
  virtual PointValues values_at(const BlockRange& own, std::span<const Vec3f> points,
                                std::span<const double> faces) = 0;

  /// What the blocks have counted so far. Waits.
  [[nodiscard]] virtual diagnose::Counts looks() = 0;
};

/// @param ex      the space; shared.host if it is the host
/// @param shared  outlives what is returned
template <exec::Space Exec>
std::unique_ptr<BlockWork> make_block_work(Exec& ex, SharedOfBlocks& shared);

}  // namespace pointskin::scale
