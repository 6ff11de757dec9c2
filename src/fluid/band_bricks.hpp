// Bricks of a band's levels: which particles reach them, and who is whose neighbour.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "core/bits.hpp"
#include "exec/atomic.hpp"
#include "fluid/particle_tree.hpp"
#include "fluid/walls.hpp"
#include "octree/brick_links.hpp"
#include "octree/brick_sets.hpp"
#include "octree/view.hpp"

namespace pointskin::fluid {

/// 1 for cells of particles so well surrounded that no surface is near: the cells around them hold `total` together,
/// none is empty, and no wall is within half a cell.
struct FindDeep {
  octree::LevelView cells;
  std::int32_t total;
  Walls walls;
  float width;  // of the cells, unit cube
  ArrayView<std::uint8_t> deep;
  PSK_HD void operator()(std::int64_t i) const {
    const auto cell = static_cast<std::int32_t>(i);
    std::int32_t sum = 0;
    bool full = true;
    for (int j = 0; j < octree::kNeighbours && full; ++j) {
      const std::int32_t other = cells.neighbour(cell, j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1);
      const std::int32_t count = other < 0 ? 0 : cells.point_begin[other + 1] - cells.point_begin[other];
      sum += count;
      full = count > 0;
    }
    deep[i] = full && sum >= total && !is_at_wall(cell) ? 1 : 0;
  }
  [[nodiscard]] PSK_HD bool is_at_wall(std::int32_t cell) const {
    if (walls.cells == 0) return false;
    const octree::Coordinates c = octree::decode(cells.node_key(cell));
    const auto middle = [this](std::int32_t v) { return (static_cast<float>(v) + 0.5F) * width; };
    return !(walls.depth({middle(c.x), middle(c.y), middle(c.z)}) > walls.cells * width);
  }
};

/// The bricks of the coarse level that a particle that is not deep reaches, and one cell above those, where corners of
/// the last cells have their owners.
struct ReachOfParticle {
  ParticleTreeView tree;
  ArrayView<const std::uint8_t> deep;  // empty: none is
  ArrayView<const Vec3f> centres;
  int depth;    // of the coarse cells
  float reach;  // unit cube
  Walls walls;  // what lies beyond are images: what they reach within, the particle reaches, too

  template <class Visit>
  PSK_HD void operator()(std::int64_t i, const Visit& visit) const {
    if (!deep.empty() && deep[tree.cell[i]] != 0) return;
    const Vec3f p = centres[i];
    if (walls.depth(p) < 0) return;
    const float side = static_cast<float>(1 << depth);
    const std::int32_t last = (1 << (depth - 1)) - 1;
    const auto lower = [&](float v) {
      const float cell = (v - reach) * side;
      return cell > 0 ? static_cast<std::int32_t>(cell) >> 1 : 0;
    };
    const auto upper = [&](float v) {
      const float cell = (v + reach) * side;
      const std::int32_t brick = cell > 0 ? (static_cast<std::int32_t>(cell) + 1) >> 1 : 0;
      return brick < last ? brick : last;
    };
    for (std::int32_t x = lower(p.x); x <= upper(p.x); ++x)
      for (std::int32_t y = lower(p.y); y <= upper(p.y); ++y)
        for (std::int32_t z = lower(p.z); z <= upper(p.z); ++z) visit(octree::encode({x, y, z}));
  }
};

struct MarkReach {
  ReachOfParticle reach_of;
  octree::build::BrickBits bits;
  PSK_HD void operator()(std::int64_t i) const {
    reach_of(i, [&](std::uint64_t brick) { bits.insert(brick); });
  }
};

/// For cubes too large for a bitmap: counted, then listed.
struct CountReach {
  ReachOfParticle reach_of;
  ArrayView<std::int32_t> counts;
  PSK_HD void operator()(std::int64_t i) const {
    std::int32_t count = 0;
    reach_of(i, [&](std::uint64_t) { ++count; });
    counts[i] = count;
  }
};

struct ListReach {
  ReachOfParticle reach_of;
  ArrayView<const std::int32_t> first;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const {
    std::int32_t at = first[i];
    reach_of(i, [&](std::uint64_t brick) { keys[at++] = brick; });
  }
};

/// Brick with a key: by its place in the bitmap, or among the sorted keys.
struct BrickIndex {
  const std::uint32_t* words;  // null: search
  const std::int32_t* before;  // bricks before each word
  ArrayView<const std::uint64_t> keys;

  [[nodiscard]] PSK_HD std::int32_t find(std::uint64_t key) const {
    if (words == nullptr) {
      const std::int64_t node = octree::find_node(keys, key << 3);
      return keys[node >> 3] == key ? static_cast<std::int32_t>(node >> 3) : -1;
    }
    const std::uint32_t word = words[key / octree::build::kWordBits];
    const std::uint32_t bit = 1U << (key % octree::build::kWordBits);
    if ((word & bit) == 0) return -1;
    return before[key / octree::build::kWordBits] + count_bits(word & (bit - 1));
  }
};

struct FindBrickNeighbour {
  int depth;
  BrickIndex index;
  ArrayView<std::int32_t> neighbours;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t brick = i / octree::kNeighbours;
    const auto j = static_cast<int>(i - brick * octree::kNeighbours);
    const octree::Coordinates b = octree::decode(index.keys[brick]);
    const octree::Coordinates c{b.x + j / 9 - 1, b.y + j / 3 % 3 - 1, b.z + j % 3 - 1};
    const std::int32_t side = 1 << (depth - 1);
    const bool in_cube = c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < side && c.y < side && c.z < side;
    neighbours[i] = in_cube ? index.find(octree::encode(c)) : -1;
  }
};

}  // namespace pointskin::fluid
