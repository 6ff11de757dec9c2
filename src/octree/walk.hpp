// The way from the root of a tree to the points near a place, for all that searches.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "octree/access.hpp"
#include "octree/search.hpp"

namespace pointskin::octree {

/// A cell is scanned point by point when it holds no more than this.
inline constexpr std::int32_t kScanPoints = 16;

PSK_HD inline float squared_distance(const Vec3f& a, const Vec3f& b) {
  const float x = a.x - b.x;
  const float y = a.y - b.y;
  const float z = a.z - b.z;
  return x * x + y * y + z * z;
}

/// Squared distance to a cell, a little less than exact so that rounding prunes nothing.
PSK_HD inline float squared_distance_to_cell(const Vec3f& q, const Coordinates& c, int depth) {
  const float width = 1.0F / static_cast<float>(1 << depth);
  const auto gap = [&](float v, std::int32_t lower) {
    const float below = static_cast<float>(lower) * width - v;
    const float above = v - static_cast<float>(lower + 1) * width;
    return below > 0 ? below : above > 0 ? above : 0.0F;
  };
  const float x = gap(q.x, c.x);
  const float y = gap(q.y, c.y);
  const float z = gap(q.z, c.z);
  return (x * x + y * y + z * z) * (1 - 1e-5F);
}

/// Calls scan(first, last) for the points of every cell that `prune(squared distance)` lets pass, nearest children
/// first.
template <class Prune, class Scan>
PSK_HD void walk(const SearchView& points, const Vec3f& q, const Prune& prune, const Scan& scan) {
  struct Entry {
    std::int32_t cell;
    std::int32_t depth;
  };
  Entry stack[7 * kMaxDepth + 8];
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    const LevelView& level = points.tree.levels[entry.depth];
    const std::int32_t first = points.first_of(level, entry.cell);
    const std::int32_t last = points.first_of(level, entry.cell + 1);
    if (first == last) continue;
    const Coordinates c = decode(level.node_key(entry.cell));
    if (prune(squared_distance_to_cell(q, c, entry.depth))) continue;
    if (last - first <= kScanPoints || !points.tree.is_split(entry.depth, entry.cell)) {
      scan(first, last);
      continue;
    }
    const float half = 0.5F / static_cast<float>(1 << entry.depth);
    const int near = slot_of(q.x >= static_cast<float>(2 * c.x + 1) * half ? 1 : 0,
                             q.y >= static_cast<float>(2 * c.y + 1) * half ? 1 : 0,
                             q.z >= static_cast<float>(2 * c.z + 1) * half ? 1 : 0);
    const std::int32_t children = 8 * level.child_brick[entry.cell];
    for (int i = 7; i >= 0; --i) stack[top++] = {children + (near ^ i), entry.depth + 1};
  }
}

}  // namespace pointskin::octree
