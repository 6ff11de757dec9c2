// An implicit function on the octree, as kernels see it.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "octree/access.hpp"
#include "octree/view.hpp"

namespace pointskin::field {

/// Corner values on all levels. Inside is where the value is at least the isovalue.
struct FieldView {
  octree::OctreeView tree;
  const float* values = nullptr;  ///< over the nodes of all levels, level-major
  float isovalue = 0;
  bool closed = true;                    ///< corners on the faces of the cube count as outside
  const std::uint8_t* counts = nullptr;  ///< (bricks of all levels) 0: cells of the brick do not count, and the cell
                                         ///< above is a leaf; null: all count

  [[nodiscard]] PSK_HD float value(int level, std::int32_t node) const {
    return values[tree.levels[level].first_node + node];
  }

  [[nodiscard]] PSK_HD bool does_count(int level, std::int32_t brick) const {
    return counts == nullptr || counts[tree.levels[level].first_node / 8 + brick] != 0;
  }
  [[nodiscard]] PSK_HD bool is_cell(int level, std::int32_t node) const {
    return tree.levels[level].is_cell(node) && does_count(level, node >> 3);
  }
  /// True if the node is a cell with children that count.
  [[nodiscard]] PSK_HD bool is_split(int level, std::int32_t node) const {
    return tree.is_split(level, node) && does_count(level + 1, tree.levels[level].child_brick[node]);
  }

  /// True if the corner at these coordinates may be inside at all.
  [[nodiscard]] PSK_HD bool may_be_inside(const octree::Coordinates& c, int level) const {
    const std::int32_t last = 1 << level;
    return !closed || (c.x > 0 && c.y > 0 && c.z > 0 && c.x < last && c.y < last && c.z < last);
  }

  /// True if the corner is inside.
  [[nodiscard]] PSK_HD bool inside(int level, std::int32_t node, const octree::Coordinates& c) const {
    return value(level, node) >= isovalue && may_be_inside(c, level) && !is_cut_off(level, node, c);
  }

  /// True for the middle of a coarser leaf's edge between a face of a closed cube and an outside corner: both ends
  /// count as outside, so the middle must too, or the edge would be crossed twice.
  [[nodiscard]] PSK_HD bool is_cut_off(int level, std::int32_t node, const octree::Coordinates& c) const {
    if (!closed || node < 0 || ((c.x & 1) + (c.y & 1) + (c.z & 1)) != 1) return false;
    const std::int32_t odd = (c.x & 1) != 0 ? c.x : (c.y & 1) != 0 ? c.y : c.z;
    const std::int32_t before_last = (1 << level) - 1;
    if (odd != 1 && odd != before_last) return false;
    const octree::LevelView& l = tree.levels[level];
    if ((l.unknowns[node >> 3] >> (node & 7) & 1) != 0) return false;
    const int step = odd == 1 ? 1 : -1;
    const std::int32_t end = l.neighbour(node, step * (c.x & 1), step * (c.y & 1), step * (c.z & 1));
    return end >= 0 && value(level, end) < isovalue;
  }
};

/// Gradient at a corner by central differences of its level, per cell; one-sided where a neighbour is missing.
PSK_HD inline Vec3f gradient_at(const FieldView& f, int level, std::int32_t node) {
  const octree::LevelView& l = f.tree.levels[level];
  const float* u = f.values + l.first_node;
  const octree::Coordinates c = octree::decode(l.node_key(node));
  const std::int32_t last = 1 << level;
  const bool at_face[3] = {c.x == last, c.y == last, c.z == last};  // ghost bricks hold valueless nodes beyond
  float slope[3];
  for (int a = 0; a < 3; ++a) {
    const int dx = a == 0 ? 1 : 0;
    const int dy = a == 1 ? 1 : 0;
    const int dz = a == 2 ? 1 : 0;
    const std::int32_t lower = l.neighbour(node, -dx, -dy, -dz);
    const std::int32_t upper = at_face[a] ? -1 : l.neighbour(node, dx, dy, dz);
    const float half = lower >= 0 && upper >= 0 ? 0.5F : 1.0F;
    slope[a] = half * (u[upper >= 0 ? upper : node] - u[lower >= 0 ? lower : node]);
  }
  return {slope[0], slope[1], slope[2]};
}

}  // namespace pointskin::field
