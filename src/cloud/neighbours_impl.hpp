#pragma once

#include "cloud/neighbours.hpp"
#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/search_impl.hpp"

namespace pointskin::cloud {

/// The nearest points found so far, nearest first, at most `wanted` <= kMost of them.
template <int kMost>
struct NearestList {
  int wanted = kMost;
  int count = 0;
  std::int32_t ids[kMost];
  float squared[kMost];

  [[nodiscard]] PSK_HD bool is_full() const { return count == wanted; }
  [[nodiscard]] PSK_HD float farthest() const { return squared[wanted - 1]; }

  PSK_HD void add(std::int32_t id, float d) {
    const auto before = [&](int i) { return d < squared[i] || (d == squared[i] && id < ids[i]); };
    if (is_full() && !before(wanted - 1)) return;
    int place = is_full() ? wanted - 1 : count++;
    for (; place > 0 && before(place - 1); --place) {
      ids[place] = ids[place - 1];
      squared[place] = squared[place - 1];
    }
    ids[place] = id;
    squared[place] = d;
  }
};

namespace neighbours {

/// Nearest other points of one point.
struct Search {
  octree::SearchView points;

  template <int kMost>
  PSK_HD void operator()(std::int64_t i, NearestList<kMost>& list) const {
    const Vec3f p = points.positions[i];
    if (!find_around(i, p, list)) find_anywhere(i, p, list);
  }

 private:
  template <int kMost>
  PSK_HD void scan(std::int64_t i, const Vec3f& p, std::int32_t first, std::int32_t last,
                   NearestList<kMost>& list) const {
    for (std::int32_t j = first; j < last; ++j)
      if (j != i) list.add(j, octree::search::squared_distance(p, points.positions[j]));
  }

  /// The cells around that of the point, 27 and then 125. @returns true if nearer points cannot be elsewhere
  template <int kMost>
  PSK_HD bool find_around(std::int64_t i, const Vec3f& p, NearestList<kMost>& list) const {
    const octree::OctreeView& tree = points.tree;
    octree::Leaf at = octree::locate(tree, octree::point_key(p.x, p.y, p.z), tree.depth);
    const std::int32_t enough = list.wanted / 4;  // in the cell: of a surface's 9 cells around, what is wanted and more
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
    for (int ring = 1; ring <= 2; ++ring) {
      for (int dx = -ring; dx <= ring; ++dx)
        for (int dy = -ring; dy <= ring; ++dy)
          for (int dz = -ring; dz <= ring; ++dz) {
            const bool is_inner = dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1 && dz >= -1 && dz <= 1;
            if (ring == 2 && is_inner) continue;
            const std::int32_t cell = level.neighbour(at.cell, dx, dy, dz);
            if (level.is_cell(cell)) scan(i, p, level.point_begin[cell], level.point_begin[cell + 1], list);
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
    list.count = 0;
    const auto prune = [&](float d) { return (bounded && d > bound) || (list.is_full() && d > list.farthest()); };
    octree::search::walk(points, p, prune,
                         [&](std::int32_t first, std::int32_t last) { scan(i, p, first, last, list); });
  }
};

struct Find {
  Search search;
  ArrayView<std::int32_t> ids;
  PSK_HD void operator()(std::int64_t i) const {
    NearestList<kNeighbours> list;
    search(i, list);
    std::int32_t* out = ids.data + i * kNeighbours;
    for (int j = 0; j < kNeighbours; ++j) out[j] = j < list.count ? list.ids[j] : -1;
  }
};

}  // namespace neighbours

template <exec::Space Exec>
exec::Buffer<std::int32_t> find_neighbours(Exec& ex, const octree::SearchView& points) {
  const std::int64_t n = points.positions.size;
  auto ids = exec::make_buffer<std::int32_t>(ex, n * kNeighbours);
  for_each(ex, "normals.neighbours", n, neighbours::Find{{points}, ids.view()});
  return ids;
}

}  // namespace pointskin::cloud
