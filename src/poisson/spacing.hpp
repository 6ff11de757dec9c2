// Distance between the samples around a point: a continuous function along the surface, for cutting it where samples
// end.
// Source: the density estimate of poisson/density.hpp; Kazhdan's SurfaceTrimmer compares the octree depth at which as
// many samples lie. Differs: the counts of all levels are blended by a rational function, so that the same bits come
// out on every device, and counts are divided by what a plane through the point would give at its place in the grid.
#pragma once

#include <cmath>
#include <cstdint>

#include "exec/space.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"

namespace pointskin::poisson {

/// The hats' mean over a plane of samples through a point, relative to the samples of a cell face: between 1/2 and 1,
/// with the point's place in its cell. Exact for planes along the grid, within 15 % for others.
PSK_HD inline float plane_factor(const Vec3f& local, const Vec3f& normal) {
  const auto stretched = [](float n, float t) { return n / (t * t + (1 - t) * (1 - t)); };
  const float x = stretched(normal.x, local.x);
  const float y = stretched(normal.y, local.y);
  const float z = stretched(normal.z, local.z);
  const float squared = x * x + y * y + z * z;
  return squared > 0 ? 1 / std::sqrt(squared) : kPlaneFactor;
}

/// Sample counts as kernels read them, for distances between samples.
struct SpacingView {
  int depth = 0;  ///< finest level with counts
  const float* counts = nullptr;

  /// Side of the square that holds one sample of the surface at p, in finest cells: the side of a cell face of the
  /// real-numbered level on which kReliableSamples lie on a face, over sqrt(kReliableSamples). With f samples on a face
  /// of level k + 1, too few, and g of level k, enough, that level is k + 1 - t, t = (kReliableSamples - f) / (g - f);
  /// 4^t is taken as 1 + 3 t, which is exact where samples are even (g = 4 f). Continuous: where a level has no cell,
  /// no hat of a sample reaches.
  /// @param normal  of the surface at p, unit length; zero if unknown
  PSK_HD float cells(const octree::OctreeView& tree, const Vec3f& p, const Vec3f& normal) const {
    const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
    const octree::Leaf leaf = octree::locate(tree, key, depth);
    int level = leaf.depth;
    std::int32_t cell = leaf.cell;
    float finer = 0;
    float here = on_face(tree.levels[level], key, cell, p, normal);
    while (level > 0 && here < kReliableSamples) {
      finer = here;
      cell = tree.levels[level].parent[cell >> 3];
      --level;
      here = on_face(tree.levels[level], key, cell, p, normal);
      if (here < kLeastGrowth * finer) here = kLeastGrowth * finer;
    }
    constexpr float kFewest = 1e-6F;  // at the cube's faces there may be none
    const auto face = static_cast<float>(std::int64_t{1} << 2 * (tree.depth - level));  // in finest cells^2
    if (here < kReliableSamples || level == depth) return std::sqrt(face / (here > kFewest ? here : kFewest));
    const float t = (kReliableSamples - finer) / (here - finer);
    return std::sqrt(face * 0.25F * (1 + 3 * t) / kReliableSamples);
  }

 private:
  /// A level's counts grow at least by this from the level below: then they reach kReliableSamples at one place, which
  /// moves continuously. Samples in a line grow by 2, on a surface by 4.
  static constexpr float kLeastGrowth = 2;

  PSK_HD float on_face(const octree::LevelView& level, std::uint64_t key, std::int32_t cell, const Vec3f& p,
                       const Vec3f& normal) const {
    const Vec3f local = octree::local_in_cell(p, octree::decode(octree::cell_key(key, level.depth)), level.depth);
    return octree::interpolated(level, counts + level.first_node, cell, local) / plane_factor(local, normal);
  }
};

/// out[i] = SpacingView::cells at points of the unit cube. O(n depth).
/// @param normals  shape (n)
template <exec::Space Exec>
void evaluate_spacing(Exec& ex, const octree::OctreeData& tree, const Density& density, ArrayView<const Vec3f> points,
                      ArrayView<const Vec3f> normals, ArrayView<float> out);

/// Place, in ascending order, of the spacing that a share `sparsest` in [0, 1) of n samples exceeds.
inline std::int64_t place_of_sparsest(std::int64_t n, double sparsest) {
  const auto above = static_cast<std::int64_t>(sparsest * static_cast<double>(n));
  return n - 1 - (above < n - 1 ? above : n - 1);
}

/// The spacing, in finest cells, that a share `sparsest` in [0, 1) of the samples exceeds: at the samples themselves.
/// @param normals  shape (n), unit length or zero
/// O(n depth) and a sort of n keys; waits; 16 n bytes of scratch. Deterministic, does not depend on the order.
template <exec::Space Exec>
float spacing_of_sparsest(Exec& ex, const octree::OctreeData& tree, const Density& density,
                          ArrayView<const Vec3f> positions, ArrayView<const Vec3f> normals, double sparsest);

}  // namespace pointskin::poisson
