#include "boolean/keep_apart.hpp"

#include "exec/this_space.hpp"

namespace pointskin::boolean {
namespace {

/// Where the corner of a node lies in the unit cube; beyond it for nodes that own nothing there.
PSK_HD Vec3f corner_of(const octree::OctreeView& tree, std::int64_t index) {
  const int level = tree.level_of(index);
  const octree::LevelView& l = tree.levels[level];
  const octree::Coordinates c = octree::decode(l.node_key(static_cast<std::int32_t>(index - l.first_node)));
  const float width = 1.0F / static_cast<float>(1 << level);
  return {static_cast<float>(c.x) * width, static_cast<float>(c.y) * width, static_cast<float>(c.z) * width};
}

/// True for points in leaves of one of the two finest levels, which lie around the samples.
PSK_HD bool is_near_samples(const octree::OctreeView& tree, const Vec3f& p) {
  if (p.x > 1 || p.y > 1 || p.z > 1) return false;
  return octree::locate(tree, octree::point_key(p.x, p.y, p.z), tree.depth).depth >= tree.depth - 1;
}

struct CornerIsNear {
  octree::OctreeView tree, other;
  PSK_HD bool operator()(std::int64_t index) const {
    const octree::LevelView& l = tree.levels[tree.level_of(index)];
    const std::int64_t node = index - l.first_node;
    return (l.unknowns[node >> 3] >> (node & 7) & 1) != 0 && is_near_samples(other, corner_of(tree, index));
  }
};

struct ListCorner {
  octree::OctreeView tree;
  ArrayView<const std::int32_t> corners;
  ArrayView<Vec3f> points;
  PSK_HD void operator()(std::int64_t i) const { points[i] = corner_of(tree, corners[i]); }
};

struct PointIsNear {
  octree::OctreeView tree;
  ArrayView<const Vec3f> points;
  PSK_HD bool operator()(std::int64_t i) const { return is_near_samples(tree, points[i]); }
};

struct Lower {
  ArrayView<const std::int32_t> corners;
  ArrayView<const field::SurfaceDistance> to_a, to_b;
  float steepness;
  ArrayView<float> values;
  PSK_HD void operator()(std::int64_t i) const { values[corners[i]] -= steepness * lowered_by(to_a[i], to_b[i]); }
};

/// Corners that a level cannot choose, next to coarser leaves, hold what these interpolate: the field stays continuous.
struct Interpolate {
  octree::LevelView above, level;
  const float* above_values;
  float* values;
  PSK_HD void operator()(std::int64_t n) const {
    if ((level.unknowns[n >> 3] >> (n & 7) & 1) != 0) return;
    values[n] = octree::prolonged(above, above_values, level.parent[n >> 3], static_cast<int>(n & 7));
  }
};

}  // namespace

template <exec::Space Exec>
void keep_apart(Exec& ex, const field::FieldView& a, const field::FieldView& b, double steepness,
                const octree::OctreeView& tree, ArrayView<float> values) {
  const exec::Buffer<std::int32_t> near_b = select(ex, "boolean.near", tree.nodes, CornerIsNear{tree, b.tree});
  auto places = exec::make_buffer<Vec3f>(ex, near_b.size());
  for_each(ex, "boolean.near", near_b.size(), ListCorner{tree, near_b.cview(), places.view()});
  const exec::Buffer<std::int32_t> near_both =
      select(ex, "boolean.near", near_b.size(), PointIsNear{a.tree, places.cview()});
  const std::int64_t n = near_both.size();
  auto corners = exec::make_buffer<std::int32_t>(ex, n);
  auto points = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, near_b.cview(), near_both.cview(), corners.view());
  exec::gather(ex, ArrayView<const Vec3f>(places.cview()), near_both.cview(), points.view());
  auto to_a = exec::make_buffer<field::SurfaceDistance>(ex, n);
  auto to_b = exec::make_buffer<field::SurfaceDistance>(ex, n);
  field::measure_distances(ex, a, points.cview(), to_a.view());
  field::measure_distances(ex, b, points.cview(), to_b.view());
  for_each(ex, "boolean.apart", n,
           Lower{corners.cview(), to_a.cview(), to_b.cview(), static_cast<float>(steepness), values});
  if (n == 0) return;
  for (int d = 1; d <= tree.depth; ++d) {
    const octree::LevelView& above = tree.levels[d - 1];
    const octree::LevelView& level = tree.levels[d];
    for_each(ex, "boolean.interpolate", level.nodes(),
             Interpolate{above, level, values.data + above.first_node, values.data + level.first_node});
  }
}

PSK_INSTANTIATE(keep_apart);

}  // namespace pointskin::boolean
