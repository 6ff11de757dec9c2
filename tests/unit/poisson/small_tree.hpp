// Octrees of a few thousand nodes on the CPU, and everything about them that a test wants to look at by name.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "octree/view.hpp"
#include "poisson/samples.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {

/// Samples of the unit cube in key order and the octree around them. Areas and splat depths are left to the test.
struct SmallTree {
  /// @param normals  shape (n), or (0) for zero normals
  SmallTree(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals, int depth) {
    const auto n = static_cast<std::int64_t>(positions.size());
    std::vector<std::uint64_t> ties(positions.size());
    for (std::size_t i = 0; i < ties.size(); ++i) ties[i] = i;
    const octree::SortedPoints sorted = octree::sort_points(ex, ArrayView<const Vec3f>(positions.data(), n),
                                                            ArrayView<const std::uint64_t>(ties.data(), n));
    samples.positions = exec::make_buffer<Vec3f>(ex, n);
    samples.normals = exec::make_buffer<Vec3f>(ex, n);
    for (std::int64_t i = 0; i < n; ++i) {
      const auto from = static_cast<std::size_t>(sorted.order.data()[i]);
      samples.positions.data()[i] = positions[from];
      samples.normals.data()[i] = normals.empty() ? Vec3f{} : normals[from];
    }
    tree = octree::build_octree(ex, sorted.keys.cview(), depth);
    view = tree.view();
  }

  /// Gives every sample the same area (finest cells^2) and splat depth.
  void weigh(float area, float splat_depth) {
    const std::int64_t n = samples.positions.size();
    samples.areas = exec::make_buffer<float>(ex, n);
    samples.splat_depths = exec::make_buffer<float>(ex, n);
    for (std::int64_t i = 0; i < n; ++i) {
      samples.areas.data()[i] = area;
      samples.splat_depths.data()[i] = splat_depth;
    }
    samples.coarsest_splat_depth = static_cast<int>(splat_depth);
  }

  /// Gives samples areas between 0.5 and 1.5 and splat depths between `coarsest` and the tree's depth, half of them
  /// whole; at least one has the coarsest.
  void weigh_randomly(Random& random, int coarsest) {
    weigh(1, static_cast<float>(coarsest));
    for (std::int64_t i = 0; i < samples.areas.size(); ++i) {
      samples.areas.data()[i] = static_cast<float>(random.in(0.5, 1.5));
      if (i == 0 || coarsest == view.depth) continue;
      const bool whole = random.below(2) == 0;
      samples.splat_depths.data()[i] = static_cast<float>(whole ? coarsest + random.below(view.depth - coarsest + 1)
                                                                : random.in(coarsest, view.depth));
    }
  }

  exec::Cpu ex{2};
  poisson::Samples samples;
  octree::OctreeData tree;
  octree::OctreeView view;
};

/// Integer coordinates of the corner that node `n` stands for; up to 2^depth, and more for nodes outside of the cube.
inline octree::Coordinates corner_at(const octree::LevelView& level, std::int64_t n) {
  return octree::decode(level.node_key(static_cast<std::int32_t>(n)));
}

/// True if the corner lies in the cube, its faces included.
inline bool in_cube(const octree::LevelView& level, const octree::Coordinates& c) {
  const std::int32_t last = 1 << level.depth;
  return c.x <= last && c.y <= last && c.z <= last;
}

inline bool is_unknown(const octree::LevelView& level, std::int64_t n) {
  return in_cube(level, corner_at(level, n)) && (level.unknowns[n >> 3] >> (n & 7) & 1) != 0;
}

/// Corner `slot` of a cell.
inline std::int32_t corner_of(const octree::LevelView& level, std::int64_t cell, int slot) {
  return level.neighbour(static_cast<std::int32_t>(cell), octree::slot_x(slot), octree::slot_y(slot),
                         octree::slot_z(slot));
}

/// `n` points around `clusters` places of the box [lower, upper]^3, so that leaves of all sizes meet.
inline std::vector<Vec3f> clustered_points(Random& random, int clusters, int n, double radius, double lower = 0.02,
                                           double upper = 0.98) {
  std::vector<Vec3f> points;
  for (int c = 0; c < clusters; ++c) {
    const double at[3] = {random.in(lower, upper), random.in(lower, upper), random.in(lower, upper)};
    for (int i = 0; i < n; ++i) {
      float p[3];
      for (int a = 0; a < 3; ++a) {
        const double x = at[a] + random.in(-radius, radius);
        p[a] = static_cast<float>(x < lower ? lower : x > upper ? upper : x);
      }
      points.push_back({p[0], p[1], p[2]});
    }
  }
  return points;
}

/// Samples of a sphere of the unit cube with outward normals.
inline SmallTree sphere_tree(std::int64_t n, double radius, int depth, std::uint64_t seed = 1) {
  const Cloud cloud = sphere_cloud(n, seed, radius, {0.5, 0.5, 0.5});
  return {cloud.positions, cloud.normals, depth};
}

}  // namespace pointskin::test
