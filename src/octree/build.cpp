// Octree construction, level by level, in parallel over nodes.
// Source: Zhou et al. 2010, section 3 (Listings 1 and 2).
// Differs: bricks of siblings instead of nodes; padding and grading come from the 27-neighbourhoods of cells; corners,
// edges and faces are owned by position, so they need neither arrays nor sorting (docs/paper.md, P1-P3).
#include "octree/octree_data.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "exec/space.hpp"
#include "exec/this_space.hpp"
#include "octree/brick_links.hpp"
#include "octree/brick_sets.hpp"
#include "octree/complete_levels.hpp"
#include "octree/local_bricks.hpp"
#include "octree/octree_data.hpp"
#include "octree/placed.hpp"
#include "octree/tables.hpp"

namespace pointskin::octree {
namespace {

using namespace build;

struct PointKey {
  ArrayView<const Vec3f> positions;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    keys[i] = point_key(p.x, p.y, p.z);
  }
};

/// The same, and the index.
struct KeyAndIndex {
  PointKey key;
  ArrayView<std::int32_t> indices;
  PSK_HD void operator()(std::int64_t i) const {
    key(i);
    indices[i] = static_cast<std::int32_t>(i);
  }
};

/// Puts points sorted by the upper bits of their keys into the order of whole keys and, where those are equal, of the
/// tie break. Points whose upper bits agree are few: each counts those that belong before it.
struct SettleRuns {
  static constexpr int kLongest = 32;

  int low_bits;  // that the points are not sorted by yet
  ArrayView<const std::uint64_t> keys;
  ArrayView<const std::int32_t> order;
  ArrayView<const std::uint64_t> tie_break;
  ArrayView<std::uint64_t> settled_keys;
  ArrayView<std::int32_t> settled_order;
  std::uint32_t* too_long;  // becomes 1 if there are runs of more than kLongest, which stay as they are

  [[nodiscard]] PSK_HD bool in_run(std::int64_t i, std::int64_t j) const {
    return j >= 0 && j < keys.size && keys[i] >> low_bits == keys[j] >> low_bits;
  }
  /// True if i belongs before j; of points the same in both, the earlier.
  [[nodiscard]] PSK_HD bool precedes(std::int64_t i, std::int64_t j) const {
    if (keys[i] != keys[j]) return keys[i] < keys[j];
    const std::uint64_t tie_i = tie_break[order[i]];
    const std::uint64_t tie_j = tie_break[order[j]];
    return tie_i != tie_j ? tie_i < tie_j : i < j;
  }

  PSK_HD void operator()(std::int64_t i) const {
    std::int64_t first = i;
    std::int64_t last = i;
    while (i - first < kLongest && in_run(i, first - 1)) --first;
    while (last - i < kLongest && in_run(i, last + 1)) ++last;
    std::int64_t at = i;
    if (last - first >= kLongest) {
      exec::set_bits(too_long, 1);
    } else {
      at = first;
      for (std::int64_t j = first; j <= last; ++j)
        if (j != i && precedes(j, i)) ++at;
    }
    settled_keys[at] = keys[i];
    settled_order[at] = order[i];
  }
};

/// Sorts points by bits [low_bits, all) of their keys and settles what shares them.
/// @param use  is called with the points while the host waits for the answer
/// @returns false if too many points do
template <exec::Space Exec>
bool sort_by_upper_bits(Exec& ex, ArrayView<const Vec3f> positions, ArrayView<const std::uint64_t> tie_break,
                        int low_bits, SortedPoints& sorted, const UseOfSorted& use) {
  constexpr int kKeyBits = 3 * kPointBits;
  const std::int64_t n = positions.size;
  sorted = {};  // of an attempt before
  auto keys = exec::make_buffer<std::uint64_t>(ex, n);
  auto order = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "octree.keys", n, KeyAndIndex{{positions, keys.view()}, order.view()});
  sort_pairs(ex, "octree.sort", keys, order, kKeyBits, low_bits);
  sorted = {exec::make_buffer<std::uint64_t>(ex, n), exec::make_buffer<std::int32_t>(ex, n)};
  auto too_long = exec::make_buffer<std::uint32_t>(ex, 1);
  exec::fill(ex, too_long.view(), 0U);
  for_each(ex, "octree.settle", n,
           SettleRuns{low_bits, keys.cview(), order.cview(), tie_break, sorted.keys.view(), sorted.order.view(),
                      too_long.data()});
  keys.reset();
  order.reset();
  std::uint32_t failed = 0;
  copy_to_host_meanwhile(ex, too_long.cview(), &failed, [&] {
    if (failed == 0) use(sorted);  // known on the host; a GPU does it before it knows
  });
  return failed == 0;
}

/// Levels that one launch works on; indices count from the first to the last.
struct LevelRange {
  int first, last;
  std::int64_t begin[kMaxDepth + 2];  // of level first + i

  [[nodiscard]] std::int64_t size() const { return begin[last - first + 1]; }
  [[nodiscard]] std::vector<std::int64_t> borders() const { return {begin + 1, begin + (last - first + 1)}; }

  /// Level of an index, which is made to count from there. Most are on the last one.
  [[nodiscard]] PSK_HD int locate(std::int64_t& i) const {
    int depth = last;
    while (i < begin[depth - first]) --depth;
    i -= begin[depth - first];
    return depth;
  }
};

/// @param count  indices of a level
template <class Count>
LevelRange make_range(int first, int last, const Count& count) {
  LevelRange range{first, last, {}};
  for (int d = first; d <= last; ++d) range.begin[d - first + 1] = range.begin[d - first] + count(d);
  return range;
}

/// No node has a brick below.
struct ClearChildren {
  LevelRange nodes;
  std::int32_t* child_brick[kMaxDepth + 1];

  PSK_HD void operator()(std::int64_t i) const {
    const int depth = nodes.locate(i);
    child_brick[depth][i] = -1;
  }
};

/// Keys and parent nodes of cell bricks: the parent is the node of the level above whose key is the brick's.
struct FindParents {
  LevelRange bricks;
  ArrayView<const std::uint64_t> keys[kMaxDepth + 1];  // of the cell bricks, also of the level above the first
  std::uint64_t* brick_key[kMaxDepth + 1];
  std::int32_t* parent[kMaxDepth + 1];
  std::int32_t* child_brick[kMaxDepth + 1];

  PSK_HD void operator()(std::int64_t b) const {
    const int depth = bricks.locate(b);
    const std::uint64_t key = keys[depth][b];
    const auto node = static_cast<std::int32_t>(find_node(keys[depth - 1], key));
    brick_key[depth][b] = key;
    parent[depth][b] = node;
    child_brick[depth - 1][node] = static_cast<std::int32_t>(b);
  }
};

/// Nodes of the level above that need a ghost brick: not split, but some node one step below them is.
struct NeedsGhost {
  LevelView above;  // its child_brick holds cell bricks only
  PSK_HD bool operator()(std::int64_t i) const {
    const auto node = static_cast<std::int32_t>(i);
    if (above.child_brick[node] >= 0) return false;
    for (int s = 1; s < 8; ++s) {
      const std::int32_t lower = above.neighbour(node, -slot_x(s), -slot_y(s), -slot_z(s));
      if (lower >= 0 && above.child_brick[lower] >= 0) return true;
    }
    return false;
  }
};

struct AddGhost {
  LevelView above;
  ArrayView<const std::int32_t> ghosts;  // their parent nodes; or, if `by_step`, 8 brick + step
  bool by_step;
  std::int32_t first;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> parent;  // of the cell bricks already
  ArrayView<std::int32_t> child_brick_above;

  [[nodiscard]] PSK_HD std::int32_t parent_of(std::int32_t ghost) const {
    const int step = ghost & 7;
    return by_step ? above.neighbour(parent[ghost >> 3], slot_x(step), slot_y(step), slot_z(step)) : ghost;
  }
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t node = parent_of(ghosts[i]);
    keys[first + i] = above.node_key(node);
    parent[first + i] = node;
    child_brick_above[node] = static_cast<std::int32_t>(first + i);
  }
};

/// A corner is an unknown if all cells around it that lie in the cube are cells of this level.
struct FindUnknowns {
  LevelRange bricks;
  LevelView levels[kMaxDepth + 1];
  std::uint8_t* unknowns[kMaxDepth + 1];

  PSK_HD void operator()(std::int64_t b) const {
    const int depth = bricks.locate(b);
    unknowns[depth][b] = static_cast<std::uint8_t>(unknowns_of(levels[depth], b));
  }

  PSK_HD static int unknowns_of(const LevelView& level, std::int64_t b) {
    const Coordinates c = decode(level.brick_key[b]);
    const std::int32_t bricks_per_axis = 1 << (level.depth - 1);
    unsigned missing = 0;  // bricks in the cube whose nodes are no cells of this level, by neighbour index
    PSK_UNROLL
    for (int j = 0; j < kNeighbours; ++j) {
      const std::int32_t brick = level.neighbours[b * kNeighbours + j];
      const std::int32_t x = c.x + j / 9 - 1;
      const std::int32_t y = c.y + j / 3 % 3 - 1;
      const std::int32_t z = c.z + j % 3 - 1;
      const bool in_cube =
          x >= 0 && y >= 0 && z >= 0 && x < bricks_per_axis && y < bricks_per_axis && z < bricks_per_axis;
      if (in_cube && (brick < 0 || brick >= level.cell_bricks)) missing |= 1U << j;
    }
    const std::int32_t last = 1 << level.depth;
    int mask = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const bool in_grid = 2 * c.x + slot_x(s) <= last && 2 * c.y + slot_y(s) <= last && 2 * c.z + slot_z(s) <= last;
      if (in_grid && (missing & bricks_of_cells_around(s)) == 0) mask |= 1 << s;
    }
    return mask;
  }

  /// Bricks that the 8 cells around corner `slot` of a brick belong to: itself and, on lower sides, those before it.
  PSK_HD static unsigned bricks_of_cells_around(int slot) {
    unsigned bricks = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s)
      if ((s & slot) == 0) bricks |= 1U << neighbour_index(-slot_x(s), -slot_y(s), -slot_z(s));
    return bricks;
  }
};

/// First of the sorted points [first, last) beyond a cell. O(log(last - first)).
PSK_HD std::int32_t end_of_cell(ArrayView<const std::uint64_t> point_keys, std::uint64_t cell, int depth,
                                std::int32_t first, std::int32_t last) {
  while (first < last) {
    const std::int32_t middle = first + (last - first) / 2;
    if (cell_key(point_keys[middle], depth) <= cell)
      first = middle + 1;
    else
      last = middle;
  }
  return first;
}

/// First points of the cells of all levels at once, for spaces with many threads.
struct FindAllPoints {
  LevelRange entries;
  OctreeView tree;
  std::int32_t* point_begin[kMaxDepth + 1];
  ArrayView<const std::uint64_t> point_keys;

  PSK_HD void operator()(std::int64_t cell) const {
    const int depth = entries.locate(cell);
    const LevelView& level = tree.levels[depth];
    const auto points = static_cast<std::int32_t>(point_keys.size);
    std::int32_t first = points;
    if (cell < level.cells()) {
      const std::uint64_t key = level.node_key(static_cast<std::int32_t>(cell));
      first = key == 0 ? 0 : end_of_cell(point_keys, key - 1, depth, 0, points);
    }
    point_begin[depth][cell] = first;
  }
};

/// First points of the cells of a brick, found in the range of the cell it divides, for spaces with few threads.
struct FindPoints {
  LevelView level;
  const std::int32_t* above_begin;
  ArrayView<const std::uint64_t> point_keys;
  ArrayView<std::int32_t> point_begin;

  PSK_HD void operator()(std::int64_t b) const {
    if (b == level.cell_bricks) {
      point_begin[8 * b] = static_cast<std::int32_t>(point_keys.size);
      return;
    }
    const std::int32_t node = level.parent[b];
    std::int32_t first = above_begin[node];
    const std::int32_t last = above_begin[node + 1];
    for (int s = 0; s < 8; ++s) {
      point_begin[8 * b + s] = first;
      if (s == 7) return;
      first = end_of_cell(point_keys, level.brick_key[b] << 3 | static_cast<unsigned>(s), level.depth, first, last);
    }
  }
};

/// The root cell holds all points.
struct RootPoints {
  std::int32_t points;
  ArrayView<std::int32_t> point_begin;
  PSK_HD void operator()(std::int64_t i) const { point_begin[i] = i == 0 ? 0 : points; }
};

/// Ids and parents of the cell bricks of levels first..last, with room for the ghosts that are known. Three launches.
template <exec::Space Exec>
void link_cells(Exec& ex, OctreeData& tree, int first, int last, BrickSets& sets) {
  const auto data = [&](int d) -> LevelData& { return tree.levels[static_cast<std::size_t>(d)]; };
  FindParents parents{};
  ClearChildren clear{};
  parents.keys[first - 1] = data(first - 1).brick_key.cview().part(0, data(first - 1).cell_bricks);
  for (int d = first; d <= last; ++d) {
    LevelData& level = data(d);
    LevelData& above = data(d - 1);
    const exec::Buffer<std::uint64_t>& keys = sets.keys[static_cast<std::size_t>(d)];
    const std::int64_t bricks = keys.size() + (sets.has_ghosts(d) ? sets.ghosts_of(d).size : 0);
    check_limit(bricks, d);
    level.cell_bricks = static_cast<std::int32_t>(keys.size());
    level.bricks = static_cast<std::int32_t>(bricks);
    {
      const auto placed = placed_on_level(ex, level);
      level.brick_key = exec::make_buffer<std::uint64_t>(ex, bricks);
      level.parent = exec::make_buffer<std::int32_t>(ex, bricks);
    }
    const auto placed = placed_on_level(ex, above);
    above.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * above.bricks);
    parents.keys[d] = keys.cview();
    parents.brick_key[d] = level.brick_key.data();
    parents.parent[d] = level.parent.data();
    parents.child_brick[d - 1] = clear.child_brick[d - 1] = above.child_brick.data();
  }
  clear.nodes = make_range(first - 1, last - 1, [&](int d) { return data(d).child_brick.size(); });
  parents.bricks = make_range(first, last, [&](int d) { return data(d).cell_bricks; });
  for_each(ex, "octree.parents", clear.nodes.size(), clear);
  {
    const exec::Placed placed(ex, parents.bricks.borders(), parents.bricks.size());
    for_each(ex, "octree.parents", parents.bricks.size(), parents);
  }
  for (int d = first; d <= last; ++d) sets.keys[static_cast<std::size_t>(d)].reset();
}

/// Makes an array longer; what is new is not initialised.
template <class T, exec::Space Exec>
void extend(Exec& ex, exec::Buffer<T>& array, std::int64_t size) {
  if (size == array.size()) return;
  auto longer = exec::make_buffer<T>(ex, size);
  copy(ex, array.cview(), longer.view().part(0, array.size()));
  array = std::move(longer);
}

/// Ascending numbers, as many as there are below `end`.
struct CountBelow {
  ArrayView<const std::int32_t> numbers;
  std::int64_t end;
  ArrayView<std::int32_t> count;
  PSK_HD void operator()(std::int64_t) const {
    std::int64_t low = 0;
    std::int64_t high = numbers.size;
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      if (numbers[middle] < end)
        low = middle + 1;
      else
        high = middle;
    }
    count[0] = static_cast<std::int32_t>(low);
  }
};

/// Ghosts in the order of the cells: all that are known beforehand; else those whose parents are cells, which come first. Only where
/// arrays are placed does it matter.
template <exec::Space Exec>
std::int32_t near_ghosts(Exec& ex, const LevelView& above, ArrayView<const std::int32_t> ghosts, bool is_known) {
  if (is_known || !exec::is_shared(ex)) return static_cast<std::int32_t>(ghosts.size);
  auto count = exec::make_buffer<std::int32_t>(ex, 1);
  for_each(ex, "octree.ghosts", 1, CountBelow{ghosts, above.cells(), count.view()});
  return exec::read_element(ex, count.cview(), 0);
}

/// Ghost bricks of a level whose cell bricks are linked and whose level above is complete.
template <exec::Space Exec>
void add_ghosts(Exec& ex, OctreeData& tree, int d, const BrickSets& sets) {
  LevelData& above = tree.levels[static_cast<std::size_t>(d) - 1];
  LevelData& level = tree.levels[static_cast<std::size_t>(d)];
  const LevelView above_view = tree.view().levels[d - 1];
  const bool is_known = sets.has_ghosts(d);
  exec::Buffer<std::int32_t> parents;
  if (!is_known) {
    const auto placed = placed_on_level(ex, above_view);
    parents = select(ex, "octree.ghosts", above_view.nodes(), NeedsGhost{above_view});
  }
  const ArrayView<const std::int32_t> ghosts = is_known ? sets.ghosts_of(d) : parents.cview();
  check_limit(level.cell_bricks + ghosts.size, d);
  level.bricks = static_cast<std::int32_t>(level.cell_bricks + ghosts.size);
  level.near_ghosts = near_ghosts(ex, above_view, ghosts, is_known);
  {
    const auto placed = placed_on_level(ex, level);
    extend(ex, level.brick_key, level.bricks);
    extend(ex, level.parent, level.bricks);
  }
  for_each(ex, "octree.ghosts", ghosts.size,
           AddGhost{above_view, ghosts, is_known, level.cell_bricks, level.brick_key.view(), level.parent.view(),
                    above.child_brick.view()});
}

template <exec::Space Exec>
void find_neighbours(Exec& ex, OctreeData& tree, int d) {
  LevelData& level = tree.levels[static_cast<std::size_t>(d)];
  const auto placed = placed_on_level(ex, level);
  level.neighbours = exec::make_buffer<std::int32_t>(ex, std::int64_t{kNeighbours} * level.bricks);
  const FindNeighbours find{tree.view().levels[d - 1], level.parent.cview(), level.neighbours.view()};
  if constexpr (Exec::kManyThreads)
    for_each(ex, "octree.neighbours", level.neighbours.size(), FindNeighbour{find});
  else
    for_each(ex, "octree.neighbours", level.bricks, FindNeighboursOfBrick{find, kNeighbourTables});
}

/// Levels first..last, given the keys of their cell bricks; levels above are complete. Unless first = last, their
/// ghosts are known.
template <exec::Space Exec>
void link_levels(Exec& ex, OctreeData& tree, int first, int last, BrickSets& sets) {
  if (first > last) return;
  link_cells(ex, tree, first, last, sets);
  FindUnknowns find{};
  for (int d = first; d <= last; ++d) {
    add_ghosts(ex, tree, d, sets);
    find_neighbours(ex, tree, d);
    LevelData& level = tree.levels[static_cast<std::size_t>(d)];
    const auto placed = placed_on_level(ex, level);
    level.unknowns = exec::make_buffer<std::uint8_t>(ex, level.bricks);
    find.unknowns[d] = level.unknowns.data();
  }
  const OctreeView view = tree.view();
  std::copy_n(view.levels, last + 1, find.levels);
  find.bricks = make_range(first, last, [&](int d) { return view.levels[d].bricks; });
  std::vector<std::int64_t> borders;
  for (int d = first; d <= last; ++d) append_borders(borders, find.bricks.begin[d - first], view.levels[d]);
  const exec::Placed placed(ex, borders, find.bricks.size());
  for_each(ex, "octree.unknowns", find.bricks.size(), find);
}

/// Point ranges of all cells.
template <exec::Space Exec>
void assign_points(Exec& ex, OctreeData& tree, ArrayView<const std::uint64_t> point_keys) {
  FindAllPoints find{{}, tree.view(), {}, point_keys};
  for (int d = 0; d <= tree.depth; ++d) {
    LevelData& level = tree.levels[static_cast<std::size_t>(d)];
    level.point_begin = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * level.cell_bricks + 1);
    find.point_begin[d] = level.point_begin.data();
  }
  if constexpr (Exec::kManyThreads) {
    find.entries =
        make_range(0, tree.depth, [&](int d) { return tree.levels[static_cast<std::size_t>(d)].point_begin.size(); });
    const exec::Placed placed(ex, find.entries.borders(), find.entries.size());
    for_each(ex, "octree.points", find.entries.size(), find);
  } else {
    const LevelData& root = tree.levels.front();
    for_each(ex, "octree.points", root.point_begin.size(),
             RootPoints{static_cast<std::int32_t>(point_keys.size), root.point_begin.view()});
    for (int d = 1; d <= tree.depth; ++d) {
      const LevelData& level = tree.levels[static_cast<std::size_t>(d)];
      for_each(ex, "octree.points", std::int64_t{level.cell_bricks} + 1,
               FindPoints{tree.view().levels[d], tree.levels[static_cast<std::size_t>(d) - 1].point_begin.data(),
                          point_keys, level.point_begin.view()});
    }
  }
}

}  // namespace

template <exec::Space Exec>
SortedPoints sort_points(Exec& ex, ArrayView<const Vec3f> positions, ArrayView<const std::uint64_t> tie_break,
                         const UseOfSorted& use) {
  constexpr int kKeyBits = 3 * kPointBits;
  // Points within 2^-13 of the cube are few where there are not many points, and within 2^-16 nearly always: three or two passes of the
  // sort are saved.
  constexpr std::int64_t kNotMany = std::int64_t{1} << 20;
  constexpr int kFewerPasses = 23;
  constexpr int kFewPasses = 15;
  const std::int64_t n = positions.size;
  SortedPoints sorted;
  for (const int low_bits : {kFewerPasses, kFewPasses, 0}) {
    if (low_bits == kFewerPasses && n > kNotMany) continue;
    if (sort_by_upper_bits(ex, positions, tie_break, low_bits, sorted, use)) return sorted;
  }

  // Many points share a key: sort by the tie break first, then, stably, by key.
  sorted = {};
  auto ties = exec::make_buffer<std::uint64_t>(ex, n);
  copy(ex, tie_break, ties.view());
  sorted.order = exec::iota(ex, n);
  sort_pairs(ex, "octree.ties", ties, sorted.order, 64);
  ties.reset();
  auto tied_positions = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, positions, sorted.order.cview(), tied_positions.view());
  sorted.keys = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "octree.keys", n, PointKey{tied_positions.cview(), sorted.keys.view()});
  tied_positions.reset();
  sort_pairs(ex, "octree.sort", sorted.keys, sorted.order, kKeyBits);
  use(sorted);
  return sorted;
}

template <exec::Space Exec>
OctreeData build_octree(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth) {
  OctreeData tree;
  tree.depth = depth;
  tree.levels.resize(static_cast<std::size_t>(depth) + 1);

  // Reverse level order (Listing 1): which bricks exist. Those of the complete levels are known.
  BrickSets sets =
      find_brick_sets(ex, point_keys, depth, [&] { build_complete_levels(ex, tree, std::min(depth, kCompleteDepth)); });

  // Level order (Listing 2): who is whose neighbour.
  const int together = std::min(depth, sets.last_with_ghosts);
  link_levels(ex, tree, kCompleteDepth + 1, together, sets);
  for (int d = std::max(together, kCompleteDepth) + 1; d <= depth; ++d) link_levels(ex, tree, d, d, sets);
  assign_points(ex, tree, point_keys);
  return tree;
}

template <exec::Space Exec>
OctreeData build_octree_below(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth,
                              std::span<const ArrayView<const std::uint64_t>> bricks, int finest) {
  const int level = static_cast<int>(bricks.size()) - 1;
  OctreeData tree;
  tree.depth = finest;
  tree.levels.resize(static_cast<std::size_t>(depth) + 1);
  BrickSets sets;
  sets.keys.resize(static_cast<std::size_t>(finest) + 2);
  find_local_levels(ex, point_keys, finest, level, sets.keys);
  build_complete_levels(ex, tree, kCompleteDepth);
  for (int d = kCompleteDepth + 1; d <= level; ++d) {
    const ArrayView<const std::uint64_t> from = bricks[static_cast<std::size_t>(d)];
    auto& own = sets.keys[static_cast<std::size_t>(d)];
    own = exec::make_buffer<std::uint64_t>(ex, from.size);
    copy(ex, from, own.view());
  }
  for (int d = kCompleteDepth + 1; d <= finest; ++d) link_levels(ex, tree, d, d, sets);
  assign_points(ex, tree, point_keys);
  tree.depth = depth;
  if (finest == depth) return tree;
  LevelData& last = tree.levels[static_cast<std::size_t>(finest)];  // without children
  last.child_brick = exec::make_buffer<std::int32_t>(ex, std::int64_t{8} * last.bricks);
  exec::fill(ex, last.child_brick.view(), std::int32_t{-1});
  return tree;
}

template <exec::Space Exec>
std::vector<exec::Buffer<std::uint64_t>> bricks_of_points(Exec& ex, ArrayView<const std::uint64_t> point_keys,
                                                          int depth, int last) {
  BrickKeys keys(static_cast<std::size_t>(depth) + 1);
  find_local_levels(ex, point_keys, depth, last, keys);
  return keys;
}

PSK_INSTANTIATE(sort_points);
PSK_INSTANTIATE(build_octree);
PSK_INSTANTIATE(build_octree_below);
PSK_INSTANTIATE(bricks_of_points);

}  // namespace pointskin::octree
