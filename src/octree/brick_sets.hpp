// Which bricks every level needs, as sets of Morton keys.
//
// Sets are bitmaps over all possible bricks of a level while those are not many more than the points: marking a brick
// is one atomic OR, and counting the bits before a word sorts and numbers the keys at once. Levels too fine for that
// sort the keys of eight candidates a cell.
#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/bits.hpp"
#include "exec/algorithms.hpp"
#include "exec/atomic.hpp"
#include "exec/placed.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::octree {
namespace build {

inline void check_limit(std::int64_t bricks, int depth) {
  if (bricks > std::numeric_limits<std::int32_t>::max() / 8)
    throw Error(ErrorCode::over_limit, "level " + std::to_string(depth) + " of the octree needs " +
                                           std::to_string(bricks) +
                                           " bricks, more than 32-bit node ids reach; "
                                           "choose a smaller depth");
}

/// Keeps the first point of every occupied cell.
struct StartsCell {
  ArrayView<const std::uint64_t> point_keys;
  int depth;
  PSK_HD bool operator()(std::int64_t i) const {
    return i == 0 || cell_key(point_keys[i], depth) != cell_key(point_keys[i - 1], depth);
  }
};

/// The up to 8 bricks that the 27-neighbourhood of a cell touches; those outside of the cube repeat an inner one.
struct TouchedBricks {
  std::int32_t bricks_per_axis;

  PSK_HD std::int32_t brick(std::int32_t cell, int side) const {
    const std::int32_t b = (cell + (side == 0 ? -1 : 1)) >> 1;
    return b < 0 ? 0 : b >= bricks_per_axis ? bricks_per_axis - 1 : b;
  }
  template <class Visit>
  PSK_HD void operator()(std::uint64_t cell, const Visit& visit) const {
    const Coordinates c = decode(cell);
    for (int s = 0; s < 8; ++s) visit(s, encode({brick(c.x, slot_x(s)), brick(c.y, slot_y(s)), brick(c.z, slot_z(s))}));
  }
};

/// Sorting: the bricks around one cell each.
struct ListTouched {
  TouchedBricks bricks_around;
  ArrayView<const std::uint64_t> cells;
  ArrayView<std::uint64_t> touched;
  PSK_HD void operator()(std::int64_t i) const {
    bricks_around(cells[i], [&](int s, std::uint64_t brick) { touched[8 * i + s] = brick; });
  }
};

struct OccupiedCellKey {
  ArrayView<const std::uint64_t> point_keys;
  ArrayView<const std::int32_t> first_points;
  int depth;
  ArrayView<std::uint64_t> cells;
  PSK_HD void operator()(std::int64_t i) const { cells[i] = cell_key(point_keys[first_points[i]], depth); }
};

inline constexpr int kWordBits = 32;

/// Bitmap of a level's bricks.
struct BrickBits {
  std::uint32_t* words;
  PSK_HD void insert(std::uint64_t brick) const {
    exec::set_bits(words + brick / kWordBits, 1U << (brick % kWordBits));
  }
  /// The brick of a bit.
  PSK_HD std::uint64_t brick_at(std::uint64_t place) const { return place; }
};

/// The bricks around the cells of the finest level that hold points.
/// @tparam Bits  BrickBits, or what has such members (local_bricks.hpp)
template <class Bits>
struct MarkAroundPoints {
  ArrayView<const std::uint64_t> point_keys;
  int depth;
  TouchedBricks bricks_around;
  Bits bits;
  PSK_HD void operator()(std::int64_t i) const {
    if (!StartsCell{point_keys, depth}(i)) return;
    bricks_around(cell_key(point_keys[i], depth), [&](int, std::uint64_t brick) { bits.insert(brick); });
  }
};

/// The bricks around cells given by their keys.
struct MarkAroundKeys {
  ArrayView<const std::uint64_t> cells;
  TouchedBricks bricks_around;
  BrickBits bits;
  PSK_HD void operator()(std::int64_t i) const {
    bricks_around(cells[i], [&](int, std::uint64_t brick) { bits.insert(brick); });
  }
};

/// The bricks around the cells that have children: a brick's key is that of the cell it divides. A byte of the level
/// below holds the 8 cells of one brick.
template <class Bits>
struct MarkAroundBits {
  const std::uint32_t* below;
  std::int32_t bricks_per_axis;
  Bits bits;
  PSK_HD void operator()(std::int64_t place) const {
    const std::uint32_t cells = below[place >> 2] >> 8 * (place & 3) & 0xff;
    if (cells == 0) return;
    std::uint32_t touched = 0;  // by neighbour index
    PSK_UNROLL
    for (int slot = 0; slot < 8; ++slot) {
      if ((cells >> slot & 1) == 0) continue;
      PSK_UNROLL
      for (int s = 0; s < 8; ++s)  // a step of -1 from lower cells, of 1 from upper ones, or none
        touched |= 1U << neighbour_index(slot_x(s) * (2 * slot_x(slot) - 1), slot_y(s) * (2 * slot_y(slot) - 1),
                                         slot_z(s) * (2 * slot_z(slot) - 1));
    }
    const Coordinates c = decode(bits.brick_at(static_cast<std::uint64_t>(place)));
    for (; touched != 0; touched &= touched - 1) {
      const int j = lowest_bit(touched);
      const Coordinates other{c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1};
      const bool in_cube = other.x >= 0 && other.y >= 0 && other.z >= 0 && other.x < bricks_per_axis &&
                           other.y < bricks_per_axis && other.z < bricks_per_axis;
      if (in_cube) bits.insert(encode(other));
    }
  }
};

struct CountWord {
  ArrayView<const std::uint32_t> words;
  ArrayView<std::int32_t> counts;  // one more, 0
  PSK_HD void operator()(std::int64_t i) const { counts[i] = i < words.size ? count_bits(words[i]) : 0; }
};

/// The values of a scan where levels begin.
struct PickBorders {
  std::int64_t at[kMaxDepth + 2];
  ArrayView<const std::int32_t> before;
  ArrayView<std::int32_t> borders;
  PSK_HD void operator()(std::int64_t i) const { borders[i] = before[at[i]]; }
};

/// Writes the keys of the bits of one level's words.
template <class Bits>
struct ListKeys {
  Bits bits;
  const std::int32_t* before;
  std::int32_t first;  // bricks before the level
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t word) const {
    std::int32_t at = before[word] - first;
    for (std::uint32_t rest = bits.words[word]; rest != 0; rest &= rest - 1)
      keys[at++] =
          bits.brick_at(static_cast<std::uint64_t>(word) * kWordBits + static_cast<unsigned>(lowest_bit(rest)));
  }
};

/// The bricks of a level as a bitmap and, numbered by it, as keys.
struct LevelBricks {
  const std::uint32_t* words;
  const std::uint64_t* keys;
  std::int32_t bricks_per_axis;
  std::int64_t first;  // of the level among the bricks of all these levels

  [[nodiscard]] PSK_HD bool contains(const Coordinates& c) const {
    if (c.x < 0 || c.y < 0 || c.z < 0 || c.x >= bricks_per_axis || c.y >= bricks_per_axis || c.z >= bricks_per_axis)
      return false;
    const std::uint64_t brick = encode(c);
    return (words[brick / kWordBits] >> (brick % kWordBits) & 1) != 0;
  }

  /// Ghosts that a brick brings along: bit s is set if no brick stands one step s above it, and if of the bricks that
  /// stand one step below that place this is the one by the smallest step.
  [[nodiscard]] PSK_HD unsigned ghosts_of(std::uint64_t brick) const {
    const Coordinates c = decode(brick);
    std::uint32_t around = 0;
    PSK_UNROLL
    for (int j = 0; j < kNeighbours; ++j)
      if (contains({c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1})) around |= 1U << j;
    unsigned ghosts = 0;
    PSK_UNROLL
    for (int s = 1; s < 8; ++s)
      if ((around & claims_on_ghost(s)) == 0) ghosts |= 1U << s;
    return ghosts;
  }

  /// By neighbour index: the place of the ghost at step s, and the bricks below it by smaller steps.
  PSK_HD static std::uint32_t claims_on_ghost(int s) {
    std::uint32_t claims = 0;
    PSK_UNROLL
    for (int t = 0; t < 8; ++t)
      if (t < s) claims |= 1U << neighbour_index(slot_x(s) - slot_x(t), slot_y(s) - slot_y(t), slot_z(s) - slot_z(t));
    return claims;
  }
};

/// Levels in one launch, finest first: most bricks are there.
struct AllLevelBricks {
  int levels;
  LevelBricks level[kMaxDepth + 1];
  [[nodiscard]] PSK_HD const LevelBricks& of(std::int64_t brick) const {
    int i = levels - 1;
    while (brick < level[i].first) --i;
    return level[i];
  }
};

struct CountGhosts {
  AllLevelBricks bricks;
  ArrayView<std::uint8_t> masks;
  ArrayView<std::int32_t> counts;  // one more, 0
  PSK_HD void operator()(std::int64_t i) const {
    unsigned ghosts = 0;
    if (i < masks.size) {
      const LevelBricks& level = bricks.of(i);
      ghosts = level.ghosts_of(level.keys[i - level.first]);
      masks[i] = static_cast<std::uint8_t>(ghosts);
    }
    counts[i] = count_bits(ghosts);
  }
};

/// Ghosts as 8 brick + step, numbered by level.
struct ListGhosts {
  AllLevelBricks bricks;
  ArrayView<const std::uint8_t> masks;
  ArrayView<const std::int32_t> before;
  ArrayView<std::int32_t> ghosts;
  PSK_HD void operator()(std::int64_t i) const {
    std::int32_t at = before[i];
    const auto brick = static_cast<std::int32_t>(i - bricks.of(i).first);
    for (unsigned steps = masks[i]; steps != 0; steps &= steps - 1) ghosts[at++] = 8 * brick + lowest_bit(steps);
  }
};

/// Words of the bitmap of level d > kCompleteDepth.
constexpr std::int64_t bitmap_words(int d) { return (std::int64_t{1} << 3 * (d - 1)) / kWordBits; }

/// Words of bitmaps that are worth their memory, 12 bytes each for a while.
inline std::int64_t most_words(std::int64_t points) {
  constexpr std::int64_t kMostWordsPerPoint = 16;
  constexpr std::int64_t kSmall = 1 << 16;
  return std::max(kSmall, kMostWordsPerPoint * points);
}

/// Deepest level whose bitmap is worth it.
inline int deepest_bitmap(std::int64_t points, int depth) {
  int d = kCompleteDepth;
  while (d < depth && d < 13 && bitmap_words(d + 1) <= most_words(points)) ++d;
  return d;
}

/// Sorted keys of the cell bricks of every level; none for the complete ones. Levels with bitmaps have their ghosts,
/// too.
struct BrickSets {
  std::vector<exec::Buffer<std::uint64_t>> keys;
  exec::Buffer<std::int32_t> ghosts;      ///< 8 brick + step, of levels kCompleteDepth + 1..last_with_ghosts
  std::vector<std::int32_t> first_ghost;  ///< of each level, counted from kCompleteDepth + 1, and the end
  int last_with_ghosts = kCompleteDepth;

  [[nodiscard]] bool has_ghosts(int depth) const { return depth <= last_with_ghosts; }
  [[nodiscard]] ArrayView<const std::int32_t> ghosts_of(int depth) const {
    const auto i = static_cast<std::size_t>(depth - kCompleteDepth - 1);
    return ghosts.cview().part(first_ghost[i], first_ghost[i + 1] - first_ghost[i]);
  }
};
using BrickKeys = std::vector<exec::Buffer<std::uint64_t>>;

/// Keys of the cell bricks of level `depth`, given the sorted keys of the cells that they must surround.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> sort_bricks_around(Exec& ex, ArrayView<const std::uint64_t> cells, int depth) {
  check_limit(cells.size, depth);  // eight candidates a cell are counted with 32 bits
  auto touched = exec::make_buffer<std::uint64_t>(ex, 8 * cells.size);
  for_each(ex, "octree.touch", cells.size, ListTouched{{1 << (depth - 1)}, cells, touched.view()});
  exec::Buffer<std::uint64_t> bricks = exec::sort_unique(ex, "octree.bricks", std::move(touched), 3 * (depth - 1));
  check_limit(bricks.size(), depth);
  return bricks;
}

/// Levels depth..last + 1, by sorting.
template <exec::Space Exec>
void sort_levels(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth, int last, BrickKeys& keys) {
  for (int d = depth; d > last; --d) {
    auto& own = keys[static_cast<std::size_t>(d)];
    if (d < depth) {  // the key of a brick is the key of its parent cell, which has children
      own = sort_bricks_around(ex, keys[static_cast<std::size_t>(d) + 1].cview(), d);
      continue;
    }
    const auto first_points = select(ex, "octree.occupied", point_keys.size, StartsCell{point_keys, depth});
    auto cells = exec::make_buffer<std::uint64_t>(ex, first_points.size());
    for_each(ex, "octree.occupied", cells.size(),
             OccupiedCellKey{point_keys, first_points.cview(), depth, cells.view()});
    own = sort_bricks_around(ex, cells.cview(), d);
  }
}

/// Values of a scan at some positions, on the host. One round trip for all levels, while work() launches what need not wait.
template <exec::Space Exec, class Work>
std::vector<std::int32_t> read_borders(Exec& ex, const exec::Buffer<std::int32_t>& before, PickBorders pick, int count,
                                       const Work& work) {
  auto borders = exec::make_buffer<std::int32_t>(ex, count);
  pick.before = before.cview();
  pick.borders = borders.view();
  for_each(ex, "octree.count", count, pick);
  std::vector<std::int32_t> host(static_cast<std::size_t>(count));
  copy_to_host_meanwhile(ex, borders.cview(), host.data(), work);
  return host;
}

/// Ghosts of the levels whose bitmaps and keys are known.
template <exec::Space Exec>
void find_ghosts(Exec& ex, const AllLevelBricks& bricks, PickBorders first_brick, BrickSets& sets) {
  const std::int64_t all = first_brick.at[bricks.levels];
  auto masks = exec::make_buffer<std::uint8_t>(ex, all);
  auto before = exec::make_buffer<std::int32_t>(ex, all + 1);
  for_each(ex, "octree.ghosts", all + 1, CountGhosts{bricks, masks.view(), before.view()});
  exclusive_scan(ex, "octree.ghosts", before.cview(), before.view());
  sets.first_ghost = read_borders(ex, before, first_brick, bricks.levels + 1, [] {});
  sets.ghosts = exec::make_buffer<std::int32_t>(ex, sets.first_ghost.back());
  for_each(ex, "octree.ghosts", all, ListGhosts{bricks, masks.cview(), before.cview(), sets.ghosts.view()});
}

/// Levels last..kCompleteDepth + 1, by bitmaps: all marked, counted and numbered with two round trips.
template <exec::Space Exec, class Work>
void mark_levels(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth, int last, BrickSets& sets,
                 const Work& work) {
  constexpr int kFirst = kCompleteDepth + 1;
  if (last < kFirst) return work();
  BrickKeys& keys = sets.keys;
  PickBorders pick{};
  for (int d = kFirst; d <= last; ++d) pick.at[d - kFirst + 1] = pick.at[d - kFirst] + bitmap_words(d);
  const int levels = last - kFirst + 1;
  const std::int64_t words = pick.at[levels];

  exec::Placed placed(ex, {pick.at + 1, pick.at + levels + 1}, words);
  auto bits = exec::make_buffer<std::uint32_t>(ex, words);
  exec::fill(ex, bits.view(), 0U);
  const auto words_of = [&](int d) { return bits.data() + pick.at[d - kFirst]; };
  for (int d = last; d >= kFirst; --d) {
    const TouchedBricks around{1 << (d - 1)};
    const BrickBits own{words_of(d)};
    if (d == depth)
      for_each(ex, "octree.mark", point_keys.size, MarkAroundPoints<BrickBits>{point_keys, depth, around, own});
    else if (d == last)
      for_each(ex, "octree.mark", keys[static_cast<std::size_t>(d) + 1].size(),
               MarkAroundKeys{keys[static_cast<std::size_t>(d) + 1].cview(), around, own});
    else
      for_each(ex, "octree.mark", 4 * bitmap_words(d + 1),
               MarkAroundBits<BrickBits>{words_of(d + 1), 1 << (d - 1), own});
  }

  auto before = exec::make_buffer<std::int32_t>(ex, words + 1);
  for_each(ex, "octree.count", words + 1, CountWord{bits.cview(), before.view()});
  placed.end();
  exclusive_scan(ex, "octree.count", before.cview(), before.view());
  const std::vector<std::int32_t> first = read_borders(ex, before, pick, levels + 1, work);
  AllLevelBricks all{levels, {}};
  PickBorders first_brick{};
  for (int i = 0; i < levels; ++i) {
    const int d = kFirst + i;
    const std::int32_t begin = first[static_cast<std::size_t>(i)];
    const std::int32_t end = first[static_cast<std::size_t>(i) + 1];
    auto& own = keys[static_cast<std::size_t>(d)];
    own = exec::make_buffer<std::uint64_t>(ex, end - begin);
    check_limit(own.size(), d);
    for_each(ex, "octree.keys", bitmap_words(d),
             ListKeys<BrickBits>{{words_of(d)}, before.data() + pick.at[i], begin, own.view()});
    all.level[i] = {words_of(d), own.data(), 1 << (d - 1), begin};
    first_brick.at[i + 1] = end;
  }
  before.reset();
  find_ghosts(ex, all, first_brick, sets);
  sets.last_with_ghosts = last;
}

}  // namespace build

/// Sorted keys of the cell bricks of levels kCompleteDepth + 1..depth: those touched by the 27-neighbourhoods of
/// occupied cells at the finest level, of cells that have children above it.
/// @param work  is called once and launches what does not depend on them, where a GPU would have nothing to do
template <exec::Space Exec, class Work>
build::BrickSets find_brick_sets(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth, const Work& work) {
  build::BrickSets sets;
  sets.keys.resize(static_cast<std::size_t>(depth) + 2);
  const int last = build::deepest_bitmap(point_keys.size, depth);
  build::sort_levels(ex, point_keys, depth, last, sets.keys);
  build::mark_levels(ex, point_keys, depth, last, sets, work);
  return sets;
}

}  // namespace pointskin::octree
