// Filling a field over the corners of all levels, where every unknown is computed on its own.
#pragma once

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/view.hpp"

namespace pointskin::field {
namespace corners {

PSK_HD inline bool is_unknown(const octree::LevelView& level, std::int64_t node) {
  return (level.unknowns[node >> 3] >> (node & 7) & 1) != 0;
}

/// Place of a corner in the unit cube: exact.
PSK_HD inline Vec3f place_of(const octree::LevelView& level, std::int32_t node) {
  const octree::Coordinates c = octree::decode(level.node_key(node));
  const float width = 1.0F / static_cast<float>(1 << level.depth);
  return {static_cast<float>(c.x) * width, static_cast<float>(c.y) * width, static_cast<float>(c.z) * width};
}

/// Values at the unknowns of a level, whose finer levels are done: an unknown that is one of the level below, too, has
/// the same value there.
template <class ValueAt>
struct FillUnknowns {
  octree::OctreeView tree;
  int depth;
  ValueAt value_at;
  float* values;  // of all levels

  PSK_HD void operator()(std::int64_t n) const {
    const octree::LevelView& level = tree.levels[depth];
    if (!is_unknown(level, n)) return;
    const std::int64_t same = same_below(n);
    const auto node = static_cast<std::int32_t>(n);
    values[level.first_node + n] =
        same >= 0 ? values[tree.levels[depth + 1].first_node + same] : value_at(tree, depth, node);
  }

  /// The corner of the level below at the same place, if it is an unknown there; else -1.
  [[nodiscard]] PSK_HD std::int64_t same_below(std::int64_t node) const {
    if (depth == tree.depth) return -1;
    const std::int64_t brick = tree.levels[depth].child_brick[node];
    return brick >= 0 && is_unknown(tree.levels[depth + 1], 8 * brick) ? 8 * brick : -1;
  }
};

/// Corners that are no unknowns: the interpolation of the level above, whose values are there; at the root 0.
struct InterpolateOthers {
  octree::OctreeView tree;
  int depth;
  float* values;  // of all levels
  PSK_HD void operator()(std::int64_t n) const {
    const octree::LevelView& level = tree.levels[depth];
    if (is_unknown(level, n)) return;
    float value = 0;
    if (depth > 0) {
      const octree::LevelView& above = tree.levels[depth - 1];
      value = octree::prolonged(above, static_cast<const float*>(values) + above.first_node, level.parent[n >> 3],
                                static_cast<int>(n & 7));
    }
    values[level.first_node + n] = value;
  }
};

}  // namespace corners

/// values[first_node + n] = value_at(tree, depth, n) at the unknowns n of all levels, once for every place; elsewhere
/// the interpolation of the level above, so that cells of two levels agree where they meet. Two launches a level.
/// @param value_at  a function of the corner's place alone
template <exec::Space Exec, class ValueAt>
exec::Buffer<float> fill_corners(Exec& ex, const char* label, const octree::OctreeView& tree, const ValueAt& value_at) {
  auto values = exec::make_buffer<float>(ex, tree.nodes);
  for (int d = tree.depth; d >= 0; --d)
    for_each(ex, label, tree.levels[d].nodes(), corners::FillUnknowns<ValueAt>{tree, d, value_at, values.data()});
  for (int d = 0; d <= tree.depth; ++d)
    for_each(ex, label, tree.levels[d].nodes(), corners::InterpolateOthers{tree, d, values.data()});
  return values;
}

}  // namespace pointskin::field
