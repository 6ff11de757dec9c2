// The nearest other points of a point.
#pragma once

#include <bit>
#include <cstdint>

#include "octree/access.hpp"
#include "octree/walk.hpp"

namespace pointskin::normals {

/// The nearest points found so far, at most `wanted` <= kMost of them: a heap with the farthest on top, until sort().
template <int kMost>
class NearestList {
 public:
  PSK_HD explicit NearestList(int wanted = kMost) : wanted_(wanted) {}

  [[nodiscard]] PSK_HD int wanted() const { return wanted_; }
  [[nodiscard]] PSK_HD int count() const { return count_; }
  [[nodiscard]] PSK_HD bool is_full() const { return count_ == wanted_; }
  /// Squared distance of the farthest; not after sort().
  [[nodiscard]] PSK_HD float farthest() const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(keys_[0] >> 32));
  }
  [[nodiscard]] PSK_HD std::int32_t operator[](int j) const { return static_cast<std::int32_t>(keys_[j]); }

  PSK_HD void clear() { count_ = 0; }

  PSK_HD void add(std::int32_t id, float squared) {
    const std::uint64_t key =
        std::uint64_t{std::bit_cast<std::uint32_t>(squared)} << 32 | static_cast<std::uint32_t>(id);
    if (is_full()) {
      if (key < keys_[0]) sink(key, 0);
      return;
    }
    int at = count_++;
    for (; at > 0 && keys_[(at - 1) / 2] < key; at = (at - 1) / 2) keys_[at] = keys_[(at - 1) / 2];
    keys_[at] = key;
  }

  /// Nearest first, equally near ones by id.
  PSK_HD void sort() {
    const int all = count_;
    while (count_ > 1) {
      const std::uint64_t farthest = keys_[0];
      --count_;
      sink(keys_[count_], 0);
      keys_[count_] = farthest;
    }
    count_ = all;
  }

 private:
  PSK_HD void sink(std::uint64_t key, int at) {
    for (int child = 2 * at + 1; child < count_; child = 2 * at + 1) {
      if (child + 1 < count_ && keys_[child] < keys_[child + 1]) ++child;
      if (keys_[child] < key) break;
      keys_[at] = keys_[child];
      at = child;
    }
    keys_[at] = key;
  }

  int wanted_;
  int count_ = 0;
  std::uint64_t keys_[kMost];  // bits of the squared distance, then the id
};

/// Nearest other points of one point.
struct NearestSearch {
  octree::SearchView points;

  template <int kMost>
  PSK_HD void operator()(std::int64_t i, NearestList<kMost>& list) const {
    const Vec3f p = points.positions[i];
    if (!find_around(i, p, list)) find_anywhere(i, p, list);
    list.sort();
  }

 private:
  template <int kMost>
  PSK_HD void scan(std::int64_t i, const Vec3f& p, std::int32_t first, std::int32_t last,
                   NearestList<kMost>& list) const {
    for (std::int32_t j = first; j < last; ++j)
      if (j != i) list.add(j, octree::squared_distance(p, points.positions[j]));
  }

  /// The cells around that of the point, 27 and then 125. @returns true if nearer points cannot be elsewhere
  template <int kMost>
  PSK_HD bool find_around(std::int64_t i, const Vec3f& p, NearestList<kMost>& list) const {
    const octree::OctreeView& tree = points.tree;
    octree::Leaf at = octree::locate(tree, octree::point_key(p.x, p.y, p.z), tree.depth);
    const std::int32_t enough =
        list.wanted() / 4;  // in the cell: of a surface's 9 cells around, what is wanted and more
    while (at.depth > 2) {
      const octree::LevelView& level = tree.levels[at.depth];
      if (level.point_begin[at.cell + 1] - level.point_begin[at.cell] >= enough) break;
      at.cell = level.parent[at.cell >> 3];
      --at.depth;
    }
    const octree::LevelView& level = tree.levels[at.depth];
    const float width = 1.0F / static_cast<float>(1 << at.depth);
    const octree::Coordinates c = octree::decode(level.node_key(at.cell));
    const float nearest_face = distance_to_faces(p, c, width);
    const std::int32_t crowd = 16 * list.wanted();  // around a point that is alone cells are wide, and may be full
    std::int32_t seen = 0;
    for (int ring = 1; ring <= 2; ++ring) {
      for (int dx = -ring; dx <= ring; ++dx)
        for (int dy = -ring; dy <= ring; ++dy)
          for (int dz = -ring; dz <= ring; ++dz) {
            const bool is_inner = dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1 && dz >= -1 && dz <= 1;
            if (ring == 2 && is_inner) continue;
            const std::int32_t cell = level.neighbour(at.cell, dx, dy, dz);
            if (!level.is_cell(cell)) continue;
            const std::int32_t first = level.point_begin[cell];
            const std::int32_t last = level.point_begin[cell + 1];
            seen += last - first;
            if (seen > crowd) return false;
            scan(i, p, first, last, list);
          }
      const float reach = (static_cast<float>(ring) * width + nearest_face) * (1 - 1e-5F);
      if (list.is_full() && list.farthest() <= reach * reach) return true;
    }
    return false;
  }

  /// From a point of a cell to the nearest of its faces.
  PSK_HD static float distance_to_faces(const Vec3f& p, const octree::Coordinates& c, float width) {
    const auto gap = [&](float v, std::int32_t lower) {
      const float below = v - static_cast<float>(lower) * width;
      const float above = static_cast<float>(lower + 1) * width - v;
      return below < above ? below : above;
    };
    const float x = gap(p.x, c.x);
    const float y = gap(p.y, c.y);
    const float z = gap(p.z, c.z);
    const float least = x < y ? (x < z ? x : z) : (y < z ? y : z);
    return least > 0 ? least : 0;
  }

  /// From the root, nothing farther than what is found.
  template <int kMost>
  PSK_HD void find_anywhere(std::int64_t i, const Vec3f& p, NearestList<kMost>& list) const {
    const bool bounded = list.is_full();
    const float bound = bounded ? list.farthest() : 0;
    list.clear();
    const auto prune = [&](float d) { return (bounded && d > bound) || (list.is_full() && d > list.farthest()); };
    octree::walk(points, p, prune, [&](std::int32_t first, std::int32_t last) { scan(i, p, first, last, list); });
  }
};

}  // namespace pointskin::normals
