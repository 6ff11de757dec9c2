// Sampling density: how much surface each sample stands for, and which depth can carry its normal.
// Source: Kazhdan, Bolitho & Hoppe, "Poisson surface reconstruction", SGP 2006, section 4.5 (estimating local density);
// PoissonRecon's samples per node.
#pragma once

#include "exec/space.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// Samples around a cell below which an estimate of the density is taken from a coarser level.
inline constexpr float kReliableSamples = 8;

/// Mean over a cell's width of the sum of squared hats across a plane: turns splatted counts into samples per cell
/// face.
inline constexpr float kPlaneFactor = 2.0F / 3;

/// Cell faces over which samples per node are counted. Below 1 / (integral B^2)^2 = 3.3, the faces that the splat
/// kernel averages over: sparse samples are better splatted coarser (docs/decisions/0018-sparse-samples.md).
inline constexpr float kKernelFaces = 2;

/// Splatted sample counts of the coarser levels.
struct Density {
  int depth = 0;               ///< finest level with counts
  exec::Buffer<float> counts;  ///< over the nodes of levels 0..depth, level-major: sum of the samples' hats
};

/// Density as kernels read it.
struct DensityView {
  int depth = 0;
  const float* counts = nullptr;

  /// Samples per finest cell face (cells^-2) at a point of the unit cube, > 0 at samples: from the finest counted level
  /// whose cells hold kReliableSamples there.
  PSK_HD float samples_per_cell(const octree::OctreeView& tree, const Vec3f& p) const {
    int level = octree::locate(tree, octree::point_key(p.x, p.y, p.z), depth).depth;
    float samples = samples_per_face(tree, p, level);
    while (level > 0 && samples < kReliableSamples) samples = samples_per_face(tree, p, --level);
    return samples / static_cast<float>(std::int64_t{1} << 2 * (tree.depth - level));
  }

  /// Samples per cell face of a level that has a cell at p.
  PSK_HD float samples_per_face(const octree::OctreeView& tree, const Vec3f& p, int level) const {
    return octree::value_at(tree, counts, p, level) * (1 / kPlaneFactor);
  }
};

/// Samples per finest cell face to samples per unit of area; of cells so small that float does not hold it, what it holds.
struct PerArea {
  double face;  ///< area of one
  ArrayView<float> density;
  PSK_HD void operator()(std::int64_t i) const {
    constexpr double kLargest = 3.4028234663852886e38;
    const double per_area = static_cast<double>(density[i]) / face;
    density[i] = static_cast<float>(per_area < kLargest ? per_area : kLargest);
  }
};

struct WeighOptions {
  double samples_per_node = 1.5;  ///< samples the splat kernel must average over, >= 0
  bool confidence = false;        ///< weight a sample by its normal's length over the mean length
  bool has_signs = true;  ///< false where normals have no signs yet: areas and depths are then those of the density
};

/// Splats every sample's hat at level depth - 2, cell by cell, and restricts the counts to the levels above: hats are
/// nested, so the finer levels add nothing. O(8 n + 27 nodes of these levels), no atomics, deterministic.
template <exec::Space Exec>
Density splat_density(Exec& ex, const octree::OctreeData& tree, ArrayView<const Vec3f> positions);

/// Fills `samples.areas` and `splat_depths` (each from the density at its sample alone, and up to two levels below the
/// finest: find_resolution evens them out), and normalises `samples.normals` in place; with confidence, their former
/// lengths scale the areas. Areas are those on a sample's own side (own_side.hpp), outliers get none, and depths follow the
/// noise (examine.hpp).
/// @returns the density, as splat_density() has it. O(8 n + 27 nodes of the counted levels + n depth).
template <exec::Space Exec>
Density weigh_samples(Exec& ex, const octree::OctreeData& tree, const WeighOptions& options, Samples& samples);

/// weights[i] = length of normal i over the mean length, the confidence in a sample. O(n), one read-back.
template <exec::Space Exec>
exec::Buffer<float> confidence_weights(Exec& ex, ArrayView<const Vec3f> normals);

/// out[i] = samples per finest cell face (cells^-2) at points of the unit cube. O(n depth).
template <exec::Space Exec>
void evaluate_density(Exec& ex, const octree::OctreeData& tree, const Density& density, ArrayView<const Vec3f> points,
                      ArrayView<float> out);

}  // namespace pointskin::poisson
