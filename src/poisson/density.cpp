#include "poisson/density.hpp"

#include <algorithm>
#include <cmath>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "poisson/mean_length.hpp"
#include "poisson/outliers.hpp"

namespace pointskin::poisson {
namespace {

/// Hats of a cell's samples at its 8 corners: hats of a level are sums of finer hats, so no finer level is needed.
struct SumHats {
  octree::LevelView level;
  ArrayView<const Vec3f> positions;
  ArrayView<float> hats;  // (8 cells) at the corners of each cell
  PSK_HD void operator()(std::int64_t cell) const {
    float sum[8] = {};
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t last = level.point_begin[cell + 1];
    if (first < last) {
      const octree::Coordinates at = octree::decode(level.node_key(static_cast<std::int32_t>(cell)));
      PSK_UNROLL_BY_4 for (std::int32_t i = first; i < last; ++i) {
        const Vec3f local = octree::local_in_cell(positions[i], at, level.depth);
        PSK_UNROLL
        for (int s = 0; s < 8; ++s) sum[s] += octree::corner_weight(s, local);
      }
    }
    for (int s = 0; s < 8; ++s) hats[8 * cell + s] = sum[s];
  }
};

/// Sum over the 8 cells around a corner.
struct GatherHats {
  octree::LevelView level;
  ArrayView<const float> hats;
  ArrayView<float> counts;
  PSK_HD void operator()(std::int64_t n) const {
    float sum = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const std::int32_t cell =
          level.neighbour(static_cast<std::int32_t>(n), -octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s));
      if (level.is_cell(cell)) sum += hats[8 * std::int64_t{cell} + s];
    }
    counts[n] = sum;
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

/// The complete levels, one a round: each is done in less time than a launch takes.
struct RestrictLevels : exec::SweepAll {
  octree::OctreeView tree;
  int first;  // depth of round 0
  float* counts;

  PSK_HD void operator()(int round, int n, Nothing) const {
    const octree::LevelView& level = tree.levels[first - round];
    const octree::LevelView& below = tree.levels[first - round + 1];
    if (n < level.nodes())
      counts[level.first_node + n] = octree::restricted(level, below, counts + below.first_node, n);
  }
};

/// In double: floats of any size have a length.
PSK_HD double length_of(const Vec3f& n) {
  const double x = n.x;
  const double y = n.y;
  const double z = n.z;
  return std::sqrt(x * x + y * y + z * z);
}
struct RelativeLength {
  ArrayView<const Vec3f> normals;
  double mean;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<float>(length_of(normals[i]) / mean); }
};

/// Coarsest depth to splat at. Threads gather whole cells there, so a cell of a surface should not hold more than some
/// thousand samples, whatever a few outliers would need.
int coarsest_splat_depth(std::int64_t points, int depth) {
  constexpr double kMostPerCell = 4096;
  int coarsest = 2;
  while (coarsest<depth&& static_cast<double>(points)> kMostPerCell * std::pow(4.0, coarsest)) ++coarsest;
  return std::min(coarsest, depth);
}

struct Weigh {
  static constexpr int kDepthsBelow = 2;  ///< splat depths may be this far below the finest level

  octree::OctreeView tree;
  DensityView density;
  ArrayView<const Vec3f> positions;
  float samples_per_node;
  int coarsest;  // depth
  ArrayView<Vec3f> normals;
  ArrayView<float> areas;
  ArrayView<float> splat_depths;

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f n = normals[i];
    const double length = length_of(n);
    normals[i] = length > 0 ? Vec3f{static_cast<float>(n.x / length), static_cast<float>(n.y / length),
                                    static_cast<float>(n.z / length)}
                            : Vec3f{};
    const float per_cell = density.samples_per_cell(tree, positions[i]);
    areas[i] = 1 / per_cell;
    splat_depths[i] = splat_depth(per_cell * kKernelFaces);
  }

  /// @param samples  under the splat kernel at the finest level: four times more at each coarser one
  [[nodiscard]] PSK_HD float splat_depth(float samples) const {
    int finer = tree.depth + kDepthsBelow;
    samples /= static_cast<float>(1 << 2 * kDepthsBelow);
    while (finer > coarsest && 4 * samples < samples_per_node) {
      samples *= 4;
      --finer;
    }
    if (finer == coarsest || samples >= samples_per_node) return static_cast<float>(finer);
    const float share = (samples / samples_per_node - 0.25F) * (4.0F / 3);
    return static_cast<float>(finer - 1) + share;
  }
};

struct ScaleArea {
  ArrayView<const float> weights;
  ArrayView<float> areas;
  PSK_HD void operator()(std::int64_t i) const { areas[i] *= weights[i]; }
};

struct EvaluateDensity {
  octree::OctreeView tree;
  DensityView density;
  ArrayView<const Vec3f> points;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = density.samples_per_cell(tree, points[i]); }
};

}  // namespace

template <exec::Space Exec>
Density splat_density(Exec& ex, const octree::OctreeData& tree, ArrayView<const Vec3f> positions) {
  const octree::OctreeView view = tree.view();
  Density result;
  result.depth = tree.depth > 2 ? tree.depth - 2 : 0;
  const octree::LevelView& counted = view.levels[result.depth];
  result.counts = exec::make_buffer<float>(ex, counted.first_node + counted.nodes());

  auto hats = exec::make_buffer<float>(ex, 8 * counted.cells());
  for_each(ex, "density.splat", counted.cells(), SumHats{counted, positions, hats.view()});
  for_each(ex, "density.splat", counted.nodes(),
           GatherHats{counted, hats.cview(), result.counts.view().part(counted.first_node, counted.nodes())});
  const int complete = std::min(result.depth - 1, octree::kCompleteDepth);
  for (int d = result.depth - 1; d > complete; --d) {
    const octree::LevelView& level = view.levels[d];
    const octree::LevelView& below = view.levels[d + 1];
    for_each(ex, "density.restrict", level.nodes(),
             RestrictCounts{level, below, result.counts.data() + below.first_node,
                            result.counts.view().part(level.first_node, level.nodes())});
  }
  if (complete >= 0)
    sweep(ex, "density.restrict", complete + 1, view.levels[complete].nodes(),
          RestrictLevels{{}, view, complete, result.counts.data()});
  return result;
}

template <exec::Space Exec>
void weigh_samples(Exec& ex, const octree::OctreeData& tree, const Density& density, const WeighOptions& options,
                   Samples& samples) {
  const std::int64_t n = samples.positions.size();
  samples.areas = exec::make_buffer<float>(ex, n);
  samples.splat_depths = exec::make_buffer<float>(ex, n);
  exec::Buffer<float> weights;
  if (options.confidence) weights = confidence_weights(ex, samples.normals.cview());
  for_each(ex, "density.weigh", n,
           Weigh{tree.view(),
                 {density.depth, density.counts.data()},
                 samples.positions.cview(),
                 static_cast<float>(options.samples_per_node),
                 coarsest_splat_depth(n, tree.depth),
                 samples.normals.view(),
                 samples.areas.view(),
                 samples.splat_depths.view()});
  if (options.drop_outliers) drop_outliers(ex, samples);
  if (options.confidence) for_each(ex, "density.weigh", n, ScaleArea{weights.cview(), samples.areas.view()});
}

template <exec::Space Exec>
exec::Buffer<float> confidence_weights(Exec& ex, ArrayView<const Vec3f> normals) {
  auto weights = exec::make_buffer<float>(ex, normals.size);
  for_each(ex, "density.confidence", normals.size, RelativeLength{normals, mean_length(ex, normals), weights.view()});
  return weights;
}

template <exec::Space Exec>
void evaluate_density(Exec& ex, const octree::OctreeData& tree, const Density& density, ArrayView<const Vec3f> points,
                      ArrayView<float> out) {
  for_each(ex, "density.evaluate", points.size,
           EvaluateDensity{tree.view(), {density.depth, density.counts.data()}, points, out});
}

PSK_INSTANTIATE(splat_density);
PSK_INSTANTIATE(weigh_samples);
PSK_INSTANTIATE(confidence_weights);
PSK_INSTANTIATE(evaluate_density);

}  // namespace pointskin::poisson
