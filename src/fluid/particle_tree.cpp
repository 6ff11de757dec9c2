#include "fluid/particle_tree.hpp"

#include <algorithm>

#include "exec/this_space.hpp"

namespace pointskin::fluid {
namespace {

struct CellKeys {
  octree::Frame cube;
  int depth;
  ArrayView<const Vec3f> positions;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> order;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = cube.to_unit(positions[i]);
    keys[i] = octree::cell_key(octree::point_key(p.x, p.y, p.z), depth);
    order[i] = static_cast<std::int32_t>(i);
  }
};

/// 1 for the first particle of every brick; one more, 0.
struct StartsBrick {
  ArrayView<const std::uint64_t> keys;
  ArrayView<std::int32_t> starts;
  PSK_HD void operator()(std::int64_t i) const { starts[i] = i == 0 || keys[i] >> 3 != keys[i - 1] >> 3 ? 1 : 0; }
};

/// Bricks, the cell of every particle, and the first particle of every cell.
struct ListCells {
  ArrayView<const std::uint64_t> keys;
  ArrayView<const std::int32_t> before;  // bricks that start before each particle
  ArrayView<std::uint64_t> brick_key;
  ArrayView<std::int32_t> cell, point_begin;
  ArrayView<std::int32_t> table;

  /// Bricks that start up to a particle, that included, are one more than its brick's id.
  [[nodiscard]] PSK_HD std::int32_t cell_of(std::int64_t i) const {
    return 8 * (before[i + 1] - 1) + static_cast<std::int32_t>(keys[i] & 7);
  }
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t own = cell_of(i);
    const std::int32_t previous = i == 0 ? -1 : cell_of(i - 1);
    cell[i] = own;
    for (std::int32_t c = previous + 1; c <= own; ++c) point_begin[c] = static_cast<std::int32_t>(i);
    if (i + 1 == keys.size)
      for (std::int64_t c = own + 1; c < point_begin.size; ++c) point_begin[c] = static_cast<std::int32_t>(i + 1);
    if (before[i] == before[i + 1]) return;
    const std::int32_t brick = own >> 3;
    brick_key[brick] = keys[i] >> 3;
    if (!table.empty()) table[static_cast<std::int64_t>(keys[i] >> 3)] = brick;
  }
};

struct FindNeighbour {
  ParticleTreeView tree;
  ArrayView<std::int32_t> neighbours;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t brick = i / octree::kNeighbours;
    const auto j = static_cast<int>(i - brick * octree::kNeighbours);
    const octree::Coordinates b = octree::decode(tree.level.brick_key[brick]);
    const octree::Coordinates c{b.x + j / 9 - 1, b.y + j / 3 % 3 - 1, b.z + j % 3 - 1};
    const std::int32_t side = 1 << (tree.level.depth - 1);
    const bool in_cube = c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < side && c.y < side && c.z < side;
    neighbours[i] = in_cube ? tree.brick_at(octree::encode(c)) : -1;
  }
};

/// Entries of the table of bricks, or 0 if it is not worth its memory.
std::int64_t table_size(std::int64_t particles, int depth) {
  constexpr int kDeepest = 11;  // 4 GiB
  constexpr std::int64_t kSmall = 1 << 18;
  constexpr std::int64_t kMostPerParticle = 4;
  if (depth > kDeepest) return 0;
  const std::int64_t bricks = std::int64_t{1} << 3 * (depth - 1);
  return bricks <= std::max(kSmall, kMostPerParticle * particles) ? bricks : 0;
}

}  // namespace

template <exec::Space Exec>
ParticleTree build_particle_tree(Exec& ex, ArrayView<const Vec3f> positions, const CellGrid& grid) {
  constexpr const char* kLabel = "particles.cells";
  const std::int64_t n = positions.size;
  ParticleTree tree;
  tree.grid = grid;
  tree.keys = exec::make_buffer<std::uint64_t>(ex, n);
  tree.order = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "particles.keys", n, CellKeys{grid.cube, grid.depth, positions, tree.keys.view(), tree.order.view()});
  sort_pairs(ex, "particles.sort", tree.keys, tree.order, 3 * grid.depth);

  std::int64_t bricks = 0;
  auto before = exec::make_buffer<std::int32_t>(ex, n + 1);
  if (n > 0) {
    auto starts = exec::make_buffer<std::int32_t>(ex, n);
    for_each(ex, kLabel, n, StartsBrick{tree.keys.cview(), starts.view()});
    exclusive_scan(ex, kLabel, starts.cview(), before.view());
    bricks = exec::read_element(ex, before.cview(), n);
  }
  tree.brick_key = exec::make_buffer<std::uint64_t>(ex, bricks);
  tree.cell = exec::make_buffer<std::int32_t>(ex, n);
  tree.point_begin = exec::make_buffer<std::int32_t>(ex, 8 * bricks + 1);
  tree.neighbours = exec::make_buffer<std::int32_t>(ex, octree::kNeighbours * bricks);
  tree.table = exec::make_buffer<std::int32_t>(ex, table_size(n, grid.depth));
  exec::fill(ex, tree.table.view(), std::int32_t{-1});
  if (n == 0) exec::fill(ex, tree.point_begin.view(), std::int32_t{0});
  for_each(ex, kLabel, n,
           ListCells{tree.keys.cview(), before.cview(), tree.brick_key.view(), tree.cell.view(),
                     tree.point_begin.view(), tree.table.view()});
  for_each(ex, "particles.neighbours", tree.neighbours.size(), FindNeighbour{tree.view(), tree.neighbours.view()});
  return tree;
}

PSK_INSTANTIATE(build_particle_tree);

}  // namespace pointskin::fluid
