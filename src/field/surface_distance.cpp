#include "field/surface_distance.hpp"

#include <cmath>

#include "exec/this_space.hpp"

namespace pointskin::field {
namespace {

struct MeasureDistance {
  FieldView f;
  ArrayView<const Vec3f> points;
  ArrayView<SurfaceDistance> distances;

  PSK_HD void operator()(std::int64_t i) const { distances[i] = at(points[i]); }

  [[nodiscard]] PSK_HD SurfaceDistance at(const Vec3f& p) const {
    const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
    const octree::Leaf leaf = octree::locate(f.tree, key, f.tree.depth);
    const octree::LevelView& level = f.tree.levels[leaf.depth];
    const Vec3f local = octree::local_in_cell(p, octree::decode(octree::cell_key(key, leaf.depth)), leaf.depth);
    float value = 0;
    Vec3f slope{};
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = level.neighbour(leaf.cell, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      const float weight = octree::corner_weight(s, local);
      const Vec3f g = gradient_at(f, leaf.depth, corner);
      value += weight * f.value(leaf.depth, corner);
      slope = {slope.x + weight * g.x, slope.y + weight * g.y, slope.z + weight * g.z};
    }
    const float below = f.isovalue - value;
    const float length = std::sqrt(slope.x * slope.x + slope.y * slope.y + slope.z * slope.z);
    const float steepness = length / static_cast<float>(1 << (f.tree.depth - leaf.depth));  // per finest cell
    const float size = below < 0 ? -below : below;
    const float sign = below <= 0 ? -1.0F : 1.0F;
    SurfaceDistance out;
    out.steepness = steepness;
    out.cells = sign * (size < kFarCells * steepness ? size / steepness : kFarCells);
    if (length > 0) out.normal = {-slope.x / length, -slope.y / length, -slope.z / length};
    return out;
  }
};

}  // namespace

template <exec::Space Exec>
void measure_distances(Exec& ex, const FieldView& f, ArrayView<const Vec3f> points,
                       ArrayView<SurfaceDistance> distances) {
  for_each(ex, "field.distance", points.size, MeasureDistance{f, points, distances});
}

PSK_INSTANTIATE(measure_distances);

}  // namespace pointskin::field
