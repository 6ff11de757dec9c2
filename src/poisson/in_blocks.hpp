// The steps of the solver where a cloud is worked on in blocks: each block has the samples of its own cells and of a ring
// around them, and an octree whose levels 0..K have all bricks of the whole octree (octree::build_octree_below). What these
// levels hold follows from all samples and is given, and what a block finds of them in its own cells is for others to have.
// At nodes that lie far enough inside of the ring, values of finer levels have the bits that they have in the whole octree
// (docs/decisions/0057-blocks.md says how far each step reaches).
//
// Each function is defined beside the step that it is a part of, and made of the same functors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/exact_sum.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "poisson/own_side.hpp"
#include "poisson/resolution.hpp"
#include "poisson/samples.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"

namespace pointskin::poisson {

/// Depth that no sample of a cloud of so many points is splatted above. Threads gather whole cells there, so a cell of a surface
/// should not hold more than some thousand samples, whatever a few outliers would need.
inline int coarsest_splat_depth(std::int64_t points, int depth) {
  constexpr double kMostPerCell = 4096;
  int coarsest = 2;
  while (coarsest<depth&& static_cast<double>(points)> kMostPerCell * std::pow(4.0, coarsest)) ++coarsest;
  return std::min(coarsest, depth);
}

/// What weigh_samples() does to normals: unit length, or zero. Defined in density.cpp.
template <exec::Space Exec>
void normalise_normals(Exec& ex, ArrayView<Vec3f> normals);

/// The finest level that samples are counted on, of an octree of this depth.
constexpr int counted_depth(int depth) { return depth > 2 ? depth - 2 : 0; }

/// The first of the parts of weigh_samples(): sums up normals, which are unit vectors or zero.
/// @param counted  the finest level: counted_depth() of the whole octree's depth; finer ones need not be there
/// @returns shape (nodes of levels 0..counted), level-major: right at corners around which all samples are there
/// O(8 n + 27 nodes of these levels). Defined in density.cpp.
template <exec::Space Exec>
exec::Buffer<Facing> sum_facing(Exec& ex, const octree::OctreeData& tree, int counted, const Samples& samples);

/// What the second part knows of every sample, for examine_samples().
struct Weighed {
  Density density;
  exec::Buffer<float> own_side, bends;  ///< (n)
};

/// The second part: areas, and depths without noise, in `samples`. The third is examine_samples().
/// @param facing      from sum_facing(); at nodes of the given levels, sums over all samples
/// @param all_points  of the whole cloud
/// O(n depth). Defined in density.cpp.
template <exec::Space Exec>
Weighed weigh_by_facing(Exec& ex, const octree::OctreeData& tree, double samples_per_node, std::int64_t all_points,
                        ArrayView<const Facing> facing, Samples& samples);

/// Samples before and after its own that a part of the cloud needs in order to be examined.
inline constexpr std::int64_t kExamineReach = 16;

/// A part of a cloud in the order of the keys: samples first - before .. are there, and `first`..`first` + `count` - 1 are the
/// part's own. At its ends there are kExamineReach more, or the ends of the cloud.
struct PartOfCloud {
  std::int64_t first = 0, count = 0;
  std::int64_t before = 0;  ///< samples that are there before the first
  std::int64_t all = 0;     ///< of the cloud
};

/// What a look at some samples of the whole cloud adds up to. Parts add.
struct LookAtCloud {
  std::vector<std::uint64_t> words{};
  void add(const LookAtCloud& other) {
    words.resize(std::max(words.size(), other.words.size()));
    for (std::size_t i = 0; i < other.words.size(); ++i) words[i] += other.words[i];
  }
};

/// The look at the samples of a part. Defined in examine.cpp.
template <exec::Space Exec>
LookAtCloud look_at_part(Exec& ex, int depth, const PartOfCloud& part, ArrayView<const float> own_side,
                         const Samples& samples);

/// examine_samples() for a part's own samples; those of others keep what they have. Defined in examine.cpp.
/// @param look  of all parts together
template <exec::Space Exec>
void examine_part(Exec& ex, int depth, int coarsest, const PartOfCloud& part, const LookAtCloud& look,
                  exec::Buffer<float> own_side, exec::Buffer<float> bends, Samples& samples);

/// A bit beyond those of the levels.
inline constexpr std::uint32_t kSparseSamples = 1U << 31;

/// The first part of find_resolution(): evens out the splat depths of samples in bricks of level depth - 1 around which all
/// samples are there.
/// @returns (cell bricks of level depth - 1) which levels the samples of each are splatted at: bit d is level d, and
///          kSparseSamples says that the finest is not resolved
/// O(n + 27 bricks). Defined in resolution.cpp.
template <exec::Space Exec>
exec::Buffer<std::uint32_t> even_out_depths(Exec& ex, const octree::OctreeData& tree, Samples& samples);

/// Resolution::bricks from the bricks of all levels of an octree in which a sample resolves the level.
/// @param own  shape (bricks of all levels), 1 for those
/// O(27 bricks). Defined in resolution.cpp.
template <exec::Space Exec>
exec::Buffer<std::uint8_t> resolved_around(Exec& ex, const octree::OctreeView& tree, ArrayView<const std::uint8_t> own);

/// The same from the samples, but of the first levels.
/// @param given  shape (bricks of levels 0..K), of the whole octree
/// O(27 bricks + n depth). Defined in resolution.cpp.
template <exec::Space Exec>
exec::Buffer<std::uint8_t> resolved_below(Exec& ex, const octree::OctreeView& tree, const Samples& samples,
                                          ArrayView<const std::uint8_t> given);

/// The last part of find_resolution(). O(8 bricks). Defined in resolution.cpp.
template <exec::Space Exec>
Resolution resolution_of(Exec& ex, const octree::OctreeView& tree, exec::Buffer<std::uint8_t> bricks);

/// V of the last level of an octree that ends there, as splat_divergence() makes it on its way down from the samples that are
/// splatted at these levels, axis after axis: shape (3 nodes of the level). Empty if the coarsest splat depth is finer.
/// @param depth  of the whole octree
/// O(27 nodes of these levels + n). Defined in divergence.cpp.
template <exec::Space Exec>
exec::Buffer<float> splat_coarse_levels(Exec& ex, const octree::OctreeView& tree, int depth,
                                        const SamplesView& samples);

/// The divergence of these levels.
/// @param b  shape (nodes of all levels), with that of the last level; receives those of the others
/// As splat_divergence(). Defined in divergence.cpp.
template <exec::Space Exec>
void find_coarse_divergence(Exec& ex, const octree::OctreeView& tree, int depth, const SamplesView& samples,
                            const Resolution& resolution, ArrayView<float> b);

/// The divergence of levels `level`..depth; what lies above is not set.
/// @param given  V of `level`, from splat_coarse_levels()
/// @returns shape (nodes of all levels)
/// As splat_divergence(). Defined in divergence.cpp.
template <exec::Space Exec>
exec::Buffer<float> splat_divergence_below(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples,
                                           const Resolution& resolution, int level, ArrayView<const float> given);

/// Room for collapsed samples in all cells that hold points, of every level. Defined in screening.cpp.
template <exec::Space Exec>
Screening place_collapsed(Exec& ex, const octree::OctreeData& tree);

/// Collapses the samples of the levels above `level` from those of that level's cells, and finds the corners of all levels.
/// O(bricks). Defined in screening.cpp.
template <exec::Space Exec>
void collapse_above(Exec& ex, const octree::OctreeData& tree, int level, Screening& screening);

/// Solves levels `level` + 1..depth.
/// @param u  shape (nodes of all levels), with the fields of levels 0..`level`; receives the others
/// @returns what was done on the levels that were solved
/// As solve_poisson(). Defined in solve.cpp.
template <exec::Space Exec>
std::vector<LevelSolve> solve_below(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b,
                                    const Screening& screening, const SolveOptions& options, int level,
                                    ArrayView<float> u);

/// What mean_at_samples() divides: sums over the samples of some cells, which add up to those of all in any order.
struct ValuesOfSamples {
  static constexpr int kFraction = 64;

  exec::ExactSum sum;  ///< in units of 2^-fraction
  std::int64_t count = 0;
  std::int64_t cells = 0;  ///< that were looked at
  double largest = 0;      ///< magnitude of the sum of a cell

  void add(const ValuesOfSamples& other) {
    sum = exec::AddExactly{}(sum, other.sum);
    count += other.count;
    cells += other.cells;
    largest = exec::Largest{}(largest, other.largest);
  }
  /// False if the unit is too small or too large: with that of exec::fraction_for(largest) it is not.
  [[nodiscard]] bool reliable() const { return sum.reliable(cells); }
  [[nodiscard]] double mean(int fraction) const { return sum.value(fraction) / static_cast<double>(count); }
};

/// Over the samples in cells of the finest level begin..end - 1, by key.
/// O(cells + n). Defined in solve.cpp.
template <exec::Space Exec>
ValuesOfSamples values_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u,
                                  const SamplesView& samples, std::uint64_t begin, std::uint64_t end,
                                  int fraction = ValuesOfSamples::kFraction);

}  // namespace pointskin::poisson
