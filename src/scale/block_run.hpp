// A cloud to its surface block by block: what memory holds at once is one block with its ring, and the coarse levels.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/progress.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/vector.hpp>

#include "diagnose/counts.hpp"
#include "exec/any_space.hpp"
#include "exec/cpu.hpp"
#include "octree/bounding_box.hpp"
#include "octree/frame.hpp"
#include "scale/block_meshes.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/team.hpp"
#include "surface/pieces.hpp"
#include "surface/trim.hpp"

namespace pointskin::scale {

class BlockWork;
struct SharedOfBlocks;

/// How a cloud is divided, and the options of the run as Options has them.
struct BlockOptions {
  std::string folder;    ///< for temporary data: 20 bytes a sample, 4 a node, and the mesh
  int depth = 8;         ///< of the octree
  int coarse_level = 0;  ///< K in [octree::kCompleteDepth, depth - 2]: levels up to it are there as a whole; 0: chosen
  int blocks = 0;        ///< at most so many: cuts lie between cells; 0: as many as memory asks for
  std::int64_t memory_bytes = 0;  ///< that a block and the coarse levels may take, where they are to be chosen
  bool holds_to_memory = false;   ///< ends where buffers come to need more than that, once blocks are chosen
  std::int64_t part_samples = std::int64_t{1} << 20;  ///< that steps without an octree take at once, > 0
  double samples_per_node = 1.5;
  double screening = 2;
  bool fixed_screening = false;
  bool confidence = false;
  int iterations = 8;
  int ring =
      0;  ///< cells of level K around what is solved; 0: solve_ring() of block_plan.hpp, and fewer give other bytes
  float curvature = 0.5F;  ///< ExtractOptions::curvature
  bool normals = true;
  Boundary boundary = Boundary::free;
  DomainFaces domain_faces = DomainFaces::closed;
  std::optional<double> isovalue{};  ///< of the surface; unset: the mean at the samples
  bool largest = false;              ///< as Options has them
  double min_component = 0;
  double trim = 0;
  double island_ratio = 0;
  double density_face =
      0;  ///< area of a face of a finest cell in world units^2: samples per area are a column then; 0: none
  std::function<bool(const Progress&)> progress{};  ///< as Options has it, called for every block of every sweep
  Team team{};  ///< of ranks that each work on some blocks; `folder` is one that they share
};

/// What of the options of a run is for its blocks; folder, division and memory are not.
/// @param cube  of the run, in world units
BlockOptions block_options_of(const Options& options, const octree::Frame& cube);

/// The box of some points, or none.
struct BoxOfPoints {
  bool is_empty = true;
  Bounds box{};
  void add(const Vec3f& p) {
    box = is_empty ? Bounds{p, p} : octree::JoinBoxes{}(box, {p, p});
    is_empty = false;
  }
};

struct BlockReport {
  int blocks = 0;
  int coarse_level = 0;
  double isovalue = 0;
  diagnose::Counts looks{};         ///< what the fit of the whole counts, and its surface
  BoxOfPoints inliers;              ///< in the unit cube: of the samples that are no outliers
  std::int64_t lone_corners = 0;    ///< as surface::Surface has them
  double trim = 0;                  ///< share of the samples that were too sparse, where the surface was cut
  float trim_limit = 0;             ///< spacing in finest cells that it was cut at
  surface::TrimCounts cut;          ///< what was cut
  surface::PieceCounts pieces;      ///< what keep_pieces() found, if they were looked for
  std::vector<LevelReport> levels;  ///< depth 0 first, without unknowns and residuals
  std::int64_t most_samples = 0, most_nodes = 0;  ///< of a block with its ring
  std::int64_t coarse_nodes = 0;                  ///< of levels up to K
  std::int64_t samples_read = 0;                  ///< by all sweeps

  /// A pass over all samples or blocks.
  struct Sweep {
    const char* name = "";
    const char* phase = "";  ///< octree, splat, solve or extract
    double seconds = 0;
  };
  std::vector<Sweep> sweeps;
};

/// What reconstruct_blocks() would take.
struct BlockEstimate {
  int blocks = 0, coarse_level = 0;
  int ring = 0;                      ///< cells of the coarse level
  int passes = 0;                    ///< over all blocks
  std::int64_t nodes = 0;            ///< of the finer levels, in all blocks with their rings
  std::int64_t own_nodes = 0;        ///< of the whole octree there
  std::int64_t memory_bytes = 0;     ///< as planned, of the coarse levels and the largest block
  std::int64_t temporary_bytes = 0;  ///< beside the sorted cloud
};
/// @throws Error as reconstruct_blocks()
BlockEstimate estimate_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options);

/// The surface that detail::fit_field() and detail::extract() make of the same samples, without attributes of samples, with the
/// same bits for any number of blocks and any coarse level: positions in the unit cube and, if asked for, normals and density are
/// the first columns.
/// @param cloud  of at least one point
/// @throws Error usage for levels and numbers beyond their ranges; over_limit if no number of blocks does with the memory, which
///         says how much one that cannot be cut takes; output_not_written, over_limit, interrupted. Of several ranks all throw
///         FailedTogether where one has not had memory for a block
/// Sweeps over all blocks six times, and builds the octree of a block in each; once more where corners turn out to be lone ones, or
/// an automatic trim opens the faces of the cube, and once more for the density on the line of a cut. Collective: every rank has the
/// coarse levels, and all of the mesh and the report in the end.
BlockMeshes reconstruct_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                               BlockReport& report);

/// The same with the blocks in another space, such as a GPU, whose memory is what BlockOptions has limits for: the host has the
/// coarse levels, and one block's samples and mesh on their way.
BlockMeshes reconstruct_blocks(const exec::AnySpace& space, exec::Cpu& host, const SortedCloud& cloud,
                               const BlockOptions& options, BlockReport& report);

/// Calls make_block_work() of block_work.hpp with a space of the caller's.
using MakeBlockWork = std::function<std::unique_ptr<BlockWork>(SharedOfBlocks&)>;
/// The same with the blocks wherever `make` has them worked on.
BlockMeshes reconstruct_blocks(const MakeBlockWork& make, exec::Cpu& host, const SortedCloud& cloud,
                               const BlockOptions& options, BlockReport& report);

}  // namespace pointskin::scale
