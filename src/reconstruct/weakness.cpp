#include "reconstruct/weakness.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::detail {
namespace {

/// Length of the gradient of the trilinear field at p, per finest cell.
PSK_HD float gradient_length(const octree::OctreeView& tree, const float* values, const Vec3f& p) {
  const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
  const octree::Leaf leaf = octree::locate(tree, key, tree.depth);
  const octree::LevelView& level = tree.levels[leaf.depth];
  const Vec3f t = octree::local_in_cell(p, octree::decode(octree::cell_key(key, leaf.depth)), leaf.depth);
  float u[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s)
    u[s] =
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
PSK_HD float shortfall(float value, float usual) { return usual > 0 && value < usual ? 1 - value / usual : 0.0F; }

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

}  // namespace

template <exec::Space Exec>
float median_density(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                     ArrayView<const Vec3f> points) {
  return median_at(ex, points, DensityAt{tree.view(), {density.depth, density.counts.data()}});
}

template <exec::Space Exec>
WeaknessScale weakness_scale(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                             const float* values, ArrayView<const Vec3f> samples) {
  return {median_density(ex, tree, density, samples), median_at(ex, samples, GradientAt{tree.view(), values})};
}

template <exec::Space Exec>
void evaluate_weakness(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density, const float* values,
                       const WeaknessScale& scale, ArrayView<const Vec3f> points, ArrayView<float> out) {
  const octree::OctreeView view = tree.view();
  for_each(ex, "weakness", points.size,
           WeaknessAt{{view, {density.depth, density.counts.data()}}, {view, values}, scale, points, out});
}

PSK_INSTANTIATE(median_density);
PSK_INSTANTIATE(weakness_scale);
PSK_INSTANTIATE(evaluate_weakness);

}  // namespace pointskin::detail
