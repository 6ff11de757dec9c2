// Where a reconstruction is doubtful, once for every space: at points of the surface, from what the fit knows.
// Source: Sharf, Lewiner, Shklarski, Toledo & Cohen-Or, "Interactive topology-aware surface reconstruction", SIGGRAPH
// 2007, section 4 (the topology is weak where the field is flat and samples are far). Differs: the score is measured on
// the surface, against the medians at the samples, instead of at critical points of the field.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"

namespace pointskin::detail {

/// What is usual at the samples.
struct WeaknessScale {
  float density = 0;   ///< median of the samples per finest cell face
  float gradient = 0;  ///< median length of the field's gradient, per finest cell
};

namespace weakness {

/// Length of the gradient of the trilinear field at p, per finest cell.
PSK_HD inline float gradient_length(const octree::OctreeView& tree, const float* values, const Vec3f& p) {
  const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
  const octree::Leaf leaf = octree::locate(tree, key, tree.depth);
  const octree::LevelView& level = tree.levels[leaf.depth];
  const Vec3f t = octree::local_in_cell(p, octree::decode(octree::cell_key(key, leaf.depth)), leaf.depth);
  float u[8];
  PSK_UNROLL for (int s = 0; s < 8; ++s) u[s] =
      values[level.first_node + level.neighbour(leaf.cell, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s))];
  const auto mix = [](float a, float b, float w) { return a + w * (b - a); };
  const float x = mix(mix(u[4] - u[0], u[6] - u[2], t.y), mix(u[5] - u[1], u[7] - u[3], t.y), t.z);
  const float y = mix(mix(u[2] - u[0], u[6] - u[4], t.x), mix(u[3] - u[1], u[7] - u[5], t.x), t.z);
  const float z = mix(mix(u[1] - u[0], u[5] - u[4], t.x), mix(u[3] - u[2], u[7] - u[6], t.x), t.y);
  return std::sqrt(x * x + y * y + z * z) / static_cast<float>(std::int64_t{1} << (tree.depth - leaf.depth));
}

struct DensityAt {
  octree::OctreeView tree;
  poisson::DensityView density;
  PSK_HD float operator()(const Vec3f& p) const { return density.samples_per_cell(tree, p); }
};
struct GradientAt {
  octree::OctreeView tree;
  const float* values;
  PSK_HD float operator()(const Vec3f& p) const { return gradient_length(tree, values, p); }
};

/// The bits of floats that are not negative ascend with them.
template <class ValueAt>
struct BitsAt {
  ValueAt value_at;
  ArrayView<const Vec3f> points;
  ArrayView<std::uint64_t> bits;
  PSK_HD void operator()(std::int64_t i) const {
    const float value = value_at(points[i]);
    std::uint32_t word;
    memcpy(&word, &value, sizeof word);
    bits[i] = word;
  }
};

/// The lower median over `points`, of which there is one. A sort; does not depend on their order.
template <exec::Space Exec, class ValueAt>
float median_at(Exec& ex, ArrayView<const Vec3f> points, const ValueAt& value_at) {
  auto keys = exec::make_buffer<std::uint64_t>(ex, points.size);
  for_each(ex, "weakness.median", points.size, BitsAt<ValueAt>{value_at, points, keys.view()});
  sort_keys(ex, "weakness.median", keys, 32);
  const auto middle = exec::read_element(ex, keys.cview(), (points.size - 1) / 2);
  return std::bit_cast<float>(static_cast<std::uint32_t>(middle));
}

/// What is missing of the usual value, as a share of it.
PSK_HD inline float shortfall(float value, float usual) {
  return usual > 0 && value < usual ? 1 - value / usual : 0.0F;
}

struct WeaknessAt {
  DensityAt density;
  GradientAt gradient;
  WeaknessScale scale;
  ArrayView<const Vec3f> points;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    out[i] = shortfall(density(points[i]), scale.density) * shortfall(gradient(points[i]), scale.gradient);
  }
};

}  // namespace weakness

/// Medians at the samples. Two sorts of n keys; waits.
/// @param values  of the field, at the corners of all levels
template <exec::Space Exec>
WeaknessScale weakness_scale(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                             const float* values, ArrayView<const Vec3f> samples) {
  const octree::OctreeView view = tree.view();
  return {weakness::median_at(ex, samples, weakness::DensityAt{view, {density.depth, density.counts.data()}}),
          weakness::median_at(ex, samples, weakness::GradientAt{view, values})};
}

/// out[i] = (1 - min(1, density / usual)) (1 - min(1, |gradient| / usual)) at points of the unit cube: 0 where either
/// is what it is at half of the samples or more, 1 where both are 0. O(n depth).
template <exec::Space Exec>
void evaluate_weakness(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density, const float* values,
                       const WeaknessScale& scale, ArrayView<const Vec3f> points, ArrayView<float> out) {
  const octree::OctreeView view = tree.view();
  for_each(ex, "weakness", points.size,
           weakness::WeaknessAt{{view, {density.depth, density.counts.data()}}, {view, values}, scale, points, out});
}

}  // namespace pointskin::detail
