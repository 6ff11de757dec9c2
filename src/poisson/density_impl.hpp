#pragma once

#include <algorithm>
#include <cmath>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "poisson/density.hpp"
#include "poisson/splat_kernel.hpp"

namespace pointskin::poisson {
namespace density {

/// Sum of the hats of all samples at the corners of a brick.
struct SplatCounts {
  octree::LevelView level;
  ArrayView<const Vec3f> positions;
  ArrayView<float> counts;
  PSK_HD void operator()(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(level, brick);
    const auto scale = static_cast<float>(1 << level.depth);
    float sum[8] = {};
    for_points_around(level, brick, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t i = first; i < last; ++i) {
        const BrickSample sample(positions[i], origin, scale);
        if (!sample.reaches<HatKernel>()) continue;
        float w[8];
        sample.weights<HatKernel>(w);
        for (int s = 0; s < 8; ++s) sum[s] += w[s];
      }
    });
    for (int s = 0; s < 8; ++s) counts[8 * brick + s] = sum[s];
  }
};

struct RestrictCounts {
  octree::LevelView level, below;
  const float* below_counts;
  ArrayView<float> counts;
  PSK_HD void operator()(std::int64_t n) const {
    counts[n] = octree::restricted(level, below, below_counts, static_cast<std::int32_t>(n));
  }
};

/// In double: floats of any size have a length.
PSK_HD inline double length_of(const Vec3f& n) {
  const double x = n.x;
  const double y = n.y;
  const double z = n.z;
  return std::sqrt(x * x + y * y + z * z);
}
struct LengthOf {
  ArrayView<const Vec3f> normals;
  PSK_HD double operator()(std::int64_t i) const { return length_of(normals[i]); }
};
struct Plus {
  PSK_HD double operator()(double a, double b) const { return a + b; }
};

/// Coarsest depth to splat at. Threads gather whole cells there, so a cell of a surface should not hold more than some
/// thousand samples, whatever a few outliers would need.
inline int coarsest_splat_depth(std::int64_t points, int depth) {
  constexpr double kMostPerCell = 4096;
  int coarsest = 2;
  while (coarsest<depth&& static_cast<double>(points)> kMostPerCell * std::pow(4.0, coarsest)) ++coarsest;
  return std::min(coarsest, depth);
}

struct Weigh {
  octree::OctreeView tree;
  DensityView density;
  ArrayView<const Vec3f> positions;
  float samples_per_node;
  double mean_length;  // of the normals; 0: all samples weigh the same
  int coarsest;        // depth
  ArrayView<Vec3f> normals;
  ArrayView<float> areas;
  ArrayView<std::uint8_t> splat_depths;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f n = normals[i];
    const double length = length_of(n);
    normals[i] = length > 0 ? Vec3f{static_cast<float>(n.x / length), static_cast<float>(n.y / length),
                                    static_cast<float>(n.z / length)}
                            : Vec3f{};
    const float per_cell = density.samples_per_cell(tree, positions[i]);
    areas[i] = (mean_length > 0 ? static_cast<float>(length / mean_length) : 1.0F) / per_cell;
    int depth = tree.depth;
    float samples = per_cell * kKernelFaces;  // under the kernel at `depth`: four times more at each coarser one
    while (depth > coarsest && samples < samples_per_node) {
      samples *= 4;
      --depth;
    }
    splat_depths[i] = static_cast<std::uint8_t>(depth);
  }
};

struct DepthOf {
  ArrayView<const std::uint8_t> depths;
  PSK_HD std::int32_t operator()(std::int64_t i) const { return depths[i]; }
};
struct Smaller {
  PSK_HD std::int32_t operator()(std::int32_t a, std::int32_t b) const { return a < b ? a : b; }
};
struct EvaluateDensity {
  octree::OctreeView tree;
  DensityView density;
  ArrayView<const Vec3f> points;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = density.samples_per_cell(tree, points[i]); }
};

}  // namespace density

template <exec::Space Exec>
Density splat_density(Exec& ex, const octree::OctreeData& tree, ArrayView<const Vec3f> positions) {
  const octree::OctreeView view = tree.view();
  Density result;
  result.depth = tree.depth > 2 ? tree.depth - 2 : 0;
  const octree::LevelView& counted = view.levels[result.depth];
  result.counts = exec::make_buffer<float>(ex, counted.first_node + counted.nodes());

  auto below = exec::make_buffer<float>(ex, view.finest().nodes());
  for_each(ex, "density.splat", view.finest().bricks, density::SplatCounts{view.finest(), positions, below.view()});
  for (int d = view.depth - 1; d >= 0; --d) {
    const octree::LevelView& level = view.levels[d];
    exec::Buffer<float> own;
    if (d > result.depth) own = exec::make_buffer<float>(ex, level.nodes());
    const ArrayView<float> counts =
        d > result.depth ? own.view() : result.counts.view().part(level.first_node, level.nodes());
    const float* below_counts = d >= result.depth ? below.data() : result.counts.data() + view.levels[d + 1].first_node;
    for_each(ex, "density.restrict", level.nodes(),
             density::RestrictCounts{level, view.levels[d + 1], below_counts, counts});
    if (d > result.depth) below = std::move(own);
  }
  return result;
}

template <exec::Space Exec>
void weigh_samples(Exec& ex, const octree::OctreeData& tree, const Density& density, const WeighOptions& options,
                   Samples& samples) {
  const std::int64_t n = samples.positions.size();
  samples.areas = exec::make_buffer<float>(ex, n);
  samples.splat_depths = exec::make_buffer<std::uint8_t>(ex, n);
  double mean_length = 0;
  if (options.confidence)
    mean_length =
        exec::reduce<double>(ex, "density.confidence", n, density::LengthOf{samples.normals.cview()}, density::Plus{}) /
        static_cast<double>(n);
  for_each(ex, "density.weigh", n,
           density::Weigh{tree.view(),
                          {density.depth, density.counts.data()},
                          samples.positions.cview(),
                          static_cast<float>(options.samples_per_node),
                          mean_length,
                          density::coarsest_splat_depth(n, tree.depth),
                          samples.normals.view(),
                          samples.areas.view(),
                          samples.splat_depths.view()});
  samples.coarsest_splat_depth = exec::reduce<std::int32_t>(
      ex, "density.coarsest", n, density::DepthOf{samples.splat_depths.cview()}, density::Smaller{});
}

template <exec::Space Exec>
void evaluate_density(Exec& ex, const octree::OctreeData& tree, const Density& density, ArrayView<const Vec3f> points,
                      ArrayView<float> out) {
  for_each(ex, "density.evaluate", points.size,
           density::EvaluateDensity{tree.view(), {density.depth, density.counts.data()}, points, out});
}

}  // namespace pointskin::poisson
