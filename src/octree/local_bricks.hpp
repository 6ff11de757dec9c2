// Bricks of fine levels as bitmaps over a part of the cube: the cells of a coarser level that lie at points or beside them, its
// regions. A bitmap over all cells of that level numbers them, and each region has the bits of the finer cells in it. What
// sorting eight candidates for every cell would find, with an atomic OR for each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/bits.hpp"
#include "exec/algorithms.hpp"
#include "octree/brick_sets.hpp"

namespace pointskin::octree {
namespace build {

/// Cells of a level, numbered in the order of their keys.
struct RegionNumbers {
  const std::uint32_t* words;  // over all cells of the level
  const std::int32_t* before;  // regions before each word
  PSK_HD std::int64_t of(std::uint64_t region) const {
    const std::uint64_t word = region / kWordBits;
    return before[word] + count_bits(words[word] & ((1U << region % kWordBits) - 1));
  }
};

/// Bits of a level's bricks, region after region, and in each in the order of their keys.
struct LocalBits {
  RegionNumbers numbers;
  const std::uint64_t* regions;  // keys, ascending
  int bits_a_key;                // 3 for each level that the bricks' keys have below the regions'
  std::uint32_t* words;

  PSK_HD void insert(std::uint64_t brick) const {
    const std::uint64_t mask = (std::uint64_t{1} << bits_a_key) - 1;
    const auto number = static_cast<std::uint64_t>(numbers.of(brick >> bits_a_key));
    const std::uint64_t place = number << bits_a_key | (brick & mask);
    exec::set_bits(words + place / kWordBits, 1U << place % kWordBits);
  }
  PSK_HD std::uint64_t brick_at(std::uint64_t place) const {
    return regions[place >> bits_a_key] << bits_a_key | (place & ((std::uint64_t{1} << bits_a_key) - 1));
  }
};

/// The cell of every point, and the 26 around it.
struct MarkRegions {
  ArrayView<const std::uint64_t> point_keys;
  int level;
  BrickBits bits;
  PSK_HD void operator()(std::int64_t i) const {
    if (!StartsCell{point_keys, level}(i)) return;
    const Coordinates c = decode(cell_key(point_keys[i], level));
    const std::int32_t side = 1 << level;
    for (int j = 0; j < kNeighbours; ++j) {
      const Coordinates other{c.x + j / 9 - 1, c.y + j / 3 % 3 - 1, c.z + j % 3 - 1};
      const bool in_cube =
          other.x >= 0 && other.y >= 0 && other.z >= 0 && other.x < side && other.y < side && other.z < side;
      if (in_cube) bits.insert(encode(other));
    }
  }
};

/// The regions at and around points.
template <exec::Space Exec>
class Regions {
 public:
  Regions(Exec& ex, ArrayView<const std::uint64_t> point_keys, int level)
      : level_(level),
        words_(exec::make_buffer<std::uint32_t>(ex, bitmap_words(level + 1))),
        before_(exec::make_buffer<std::int32_t>(ex, words_.size() + 1)) {
    exec::fill(ex, words_.view(), 0U);
    for_each(ex, "octree.regions", point_keys.size, MarkRegions{point_keys, level, {words_.data()}});
    for_each(ex, "octree.regions", before_.size(), CountWord{words_.cview(), before_.view()});
    exclusive_scan(ex, "octree.regions", before_.cview(), before_.view());
    keys_ = exec::make_buffer<std::uint64_t>(ex, exec::read_element(ex, before_.cview(), words_.size()));
    for_each(ex, "octree.regions", words_.size(),
             ListKeys<BrickBits>{{words_.data()}, before_.data(), 0, keys_.view()});
  }

  /// Words of the bitmap of level d, whose bricks' keys are no coarser than the regions'.
  [[nodiscard]] std::int64_t words_of(int d) const {
    return ((keys_.size() << 3 * (d - 1 - level_)) + kWordBits - 1) / kWordBits;
  }
  [[nodiscard]] LocalBits bits(int d, std::uint32_t* words) const {
    return {{words_.data(), before_.data()}, keys_.data(), 3 * (d - 1 - level_), words};
  }

 private:
  int level_;
  exec::Buffer<std::uint32_t> words_;
  exec::Buffer<std::int32_t> before_;
  exec::Buffer<std::uint64_t> keys_;
};

/// Levels depth..last + 1 of bricks that follow from `point_keys`, by bitmaps of regions; by sorting where these would take much
/// more than the points. Two round trips.
/// @param last  above the complete levels, or the last of them
template <exec::Space Exec>
void find_local_levels(Exec& ex, ArrayView<const std::uint64_t> point_keys, int depth, int last, BrickKeys& keys) {
  constexpr int kCoarsest = 8, kFinest = 9;  // level of regions, but for coarser bricks: 2 or 16 MB a bitmap
  constexpr int kDeep = 4;                   // levels that regions have below them, from which on finer ones are better
  if (point_keys.empty() || depth <= last) return sort_levels(ex, point_keys, depth, last, keys);
  const Regions<Exec> regions(ex, point_keys, std::min(last, std::clamp(depth - kDeep, kCoarsest, kFinest)));
  PickBorders pick{};
  const int levels = depth - last;
  for (int i = 0; i < levels; ++i) pick.at[i + 1] = pick.at[i] + regions.words_of(last + 1 + i);
  const std::int64_t words = pick.at[levels];
  if (words > most_words(point_keys.size)) return sort_levels(ex, point_keys, depth, last, keys);

  auto bits = exec::make_buffer<std::uint32_t>(ex, words);
  exec::fill(ex, bits.view(), 0U);
  const auto bits_of = [&](int d) { return regions.bits(d, bits.data() + pick.at[d - last - 1]); };
  for (int d = depth; d > last; --d) {
    const LocalBits own = bits_of(d);
    if (d == depth)
      for_each(ex, "octree.mark", point_keys.size, MarkAroundPoints<LocalBits>{point_keys, depth, {1 << (d - 1)}, own});
    else
      for_each(ex, "octree.mark", 4 * regions.words_of(d + 1),
               MarkAroundBits<LocalBits>{bits_of(d + 1).words, 1 << (d - 1), own});
  }
  auto before = exec::make_buffer<std::int32_t>(ex, words + 1);
  for_each(ex, "octree.count", words + 1, CountWord{bits.cview(), before.view()});
  exclusive_scan(ex, "octree.count", before.cview(), before.view());
  const std::vector<std::int32_t> first = read_borders(ex, before, pick, levels + 1, [] {});
  for (int i = 0; i < levels; ++i) {
    const int d = last + 1 + i;
    const std::int32_t begin = first[static_cast<std::size_t>(i)];
    auto& own = keys[static_cast<std::size_t>(d)];
    own = exec::make_buffer<std::uint64_t>(ex, first[static_cast<std::size_t>(i) + 1] - begin);
    check_limit(own.size(), d);
    for_each(ex, "octree.keys", regions.words_of(d),
             ListKeys<LocalBits>{bits_of(d), before.data() + pick.at[i], begin, own.view()});
  }
}

}  // namespace build
}  // namespace pointskin::octree
