#include "poisson/density.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "poisson/examine.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/mean_length.hpp"
#include "poisson/own_side.hpp"
#include "poisson/sum_hats.hpp"

namespace pointskin::poisson {
namespace {

struct One {
  using Value = float;
  PSK_HD float operator()(std::int32_t /*i*/) const { return 1; }
};

struct TakeCount {
  ArrayView<const Facing> facing;
  ArrayView<float> counts;
  PSK_HD void operator()(std::int64_t n) const { counts[n] = facing[n].count; }
};

struct RelativeLength {
  ArrayView<const Vec3f> normals;
  double mean;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<float>(length_of(normals[i]) / mean); }
};

struct Normalise {
  ArrayView<Vec3f> normals;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f n = normals[i];
    const double length = length_of(n);
    normals[i] = length > 0 ? Vec3f{static_cast<float>(n.x / length), static_cast<float>(n.y / length),
                                    static_cast<float>(n.z / length)}
                            : Vec3f{};
  }
};

struct Weigh {
  static constexpr int kDepthsBelow = 3;  ///< splat depths may be this far below the finest level

  octree::OctreeView tree;
  DensityView density;
  FacingView facing;  // without sums where normals have no signs
  ArrayView<const Vec3f> positions, normals;
  float samples_per_node;
  int coarsest;                         // depth
  ArrayView<const float> bend_of_cell;  // of the finest counted level
  ArrayView<float> areas, own_side, bends;
  ArrayView<float> splat_depths;

  PSK_HD void operator()(std::int64_t i) const {
    float per_cell;
    if (facing.sums == nullptr) {
      per_cell = density.samples_per_cell(tree, positions[i]);
    } else {
      const FacingView::Densities densities = facing.at(positions[i], normals[i]);
      per_cell = densities.all;
      own_side[i] = (densities.disagrees ? -1.0F : 1.0F) / densities.own_side;
      const Vec3f p = positions[i];
      bends[i] = bend_of_cell[octree::locate(tree, octree::point_key(p.x, p.y, p.z), facing.depth).cell];
    }
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

/// How much the surface bends in the middle of a cell that holds samples.
struct BendOfCell {
  octree::LevelView level;
  FacingView facing;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t cell) const {
    if (level.point_begin[cell] == level.point_begin[cell + 1]) return;
    const octree::Coordinates at = octree::decode(level.node_key(static_cast<std::int32_t>(cell)));
    const float width = 1 / static_cast<float>(std::int64_t{1} << level.depth);
    const Vec3f middle{(static_cast<float>(at.x) + 0.5F) * width, (static_cast<float>(at.y) + 0.5F) * width,
                       (static_cast<float>(at.z) + 0.5F) * width};
    out[cell] = facing.bend_at(middle, level.depth);
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

namespace {

/// The finest level that is counted: its cells hold 16 samples of a surface that resolves the finest ones.

template <exec::Space Exec>
exec::Buffer<Facing> splat_facing(Exec& ex, const octree::OctreeView& tree, Samples& samples, Density& density) {
  density.depth = counted_depth(tree.depth);
  exec::Buffer<Facing> facing =
      sum_hats(ex, tree, density.depth, samples.positions.cview(), FacingOf{samples.normals.cview()});
  const auto placed = octree::placed_on_levels(ex, tree, density.depth);
  density.counts = exec::make_buffer<float>(ex, facing.size());
  for_each(ex, "density.splat", facing.size(), TakeCount{facing.cview(), density.counts.view()});
  return facing;
}

}  // namespace

template <exec::Space Exec>
Density splat_density(Exec& ex, const octree::OctreeData& tree, ArrayView<const Vec3f> positions) {
  const int depth = counted_depth(tree.depth);
  return {depth, sum_hats(ex, tree.view(), depth, positions, One{})};
}

template <exec::Space Exec>
void normalise_normals(Exec& ex, ArrayView<Vec3f> normals) {
  for_each(ex, "density.weigh", normals.size, Normalise{normals});
}

template <exec::Space Exec>
exec::Buffer<Facing> sum_facing(Exec& ex, const octree::OctreeData& tree, int counted, const Samples& samples) {
  return sum_hats(ex, tree.view(), counted, samples.positions.cview(), FacingOf{samples.normals.cview()});
}

template <exec::Space Exec>
Weighed weigh_by_facing(Exec& ex, const octree::OctreeData& tree, double samples_per_node, std::int64_t all_points,
                        ArrayView<const Facing> facing, Samples& samples) {
  const std::int64_t n = samples.positions.size();
  Weighed weighed{{counted_depth(tree.depth), exec::make_buffer<float>(ex, facing.size)},
                  exec::make_buffer<float>(ex, n),
                  exec::make_buffer<float>(ex, n)};
  samples.areas = exec::make_buffer<float>(ex, n);
  samples.splat_depths = exec::make_buffer<float>(ex, n);
  const Density& density = weighed.density;
  for_each(ex, "density.splat", facing.size, TakeCount{facing, weighed.density.counts.view()});
  const FacingView sums{tree.view(), density.depth, facing.data};
  const octree::LevelView& counted = tree.view().levels[density.depth];
  auto bend_of_cell = exec::make_buffer<float>(ex, counted.cells());
  for_each(ex, "density.bend", counted.cells(), BendOfCell{counted, sums, bend_of_cell.view()});
  for_each(ex, "density.weigh", n,
           Weigh{tree.view(),
                 {density.depth, density.counts.data()},
                 sums,
                 samples.positions.cview(),
                 samples.normals.cview(),
                 static_cast<float>(samples_per_node),
                 coarsest_splat_depth(all_points, tree.depth),
                 bend_of_cell.cview(),
                 samples.areas.view(),
                 weighed.own_side.view(),
                 weighed.bends.view(),
                 samples.splat_depths.view()});
  return weighed;
}

template <exec::Space Exec>
Density weigh_samples(Exec& ex, const octree::OctreeData& tree, const WeighOptions& options, Samples& samples) {
  const std::int64_t n = samples.positions.size();
  samples.areas = exec::make_buffer<float>(ex, n);
  samples.splat_depths = exec::make_buffer<float>(ex, n);
  exec::Buffer<float> weights;
  if (options.confidence) weights = confidence_weights(ex, samples.normals.cview());
  const int coarsest = coarsest_splat_depth(n, tree.depth);
  for_each(ex, "density.weigh", n, Normalise{samples.normals.view()});
  Density density;
  exec::Buffer<Facing> facing;
  exec::Buffer<float> own_side;
  exec::Buffer<float> bends;
  exec::Buffer<float> bend_of_cell;
  if (options.has_signs) {
    facing = splat_facing(ex, tree.view(), samples, density);
    const octree::LevelView& counted = tree.view().levels[density.depth];
    bend_of_cell = exec::make_buffer<float>(ex, counted.cells());
    for_each(ex, "density.bend", counted.cells(),
             BendOfCell{counted, {tree.view(), density.depth, facing.data()}, bend_of_cell.view()});
    own_side = exec::make_buffer<float>(ex, n);
    bends = exec::make_buffer<float>(ex, n);
  } else {
    density = splat_density(ex, tree, samples.positions.cview());
  }
  for_each(ex, "density.weigh", n,
           Weigh{tree.view(),
                 {density.depth, density.counts.data()},
                 {tree.view(), density.depth, facing.data()},
                 samples.positions.cview(),
                 samples.normals.cview(),
                 static_cast<float>(options.samples_per_node),
                 coarsest,
                 bend_of_cell.cview(),
                 samples.areas.view(),
                 own_side.view(),
                 bends.view(),
                 samples.splat_depths.view()});
  facing.reset();
  bend_of_cell.reset();
  if (options.has_signs) examine_samples(ex, tree.depth, coarsest, std::move(own_side), std::move(bends), samples);
  if (options.confidence) for_each(ex, "density.weigh", n, ScaleArea{weights.cview(), samples.areas.view()});
  return density;
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
PSK_INSTANTIATE(normalise_normals);
PSK_INSTANTIATE(sum_facing);
PSK_INSTANTIATE(weigh_by_facing);
PSK_INSTANTIATE(weigh_samples);
PSK_INSTANTIATE(confidence_weights);
PSK_INSTANTIATE(evaluate_density);

}  // namespace pointskin::poisson
