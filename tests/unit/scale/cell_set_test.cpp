// Sets of cells against sets of their coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include "scale/cell_set.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using octree::Coordinates;
using octree::decode;
using octree::encode;
using scale::CellSet;

using Keys = std::vector<std::uint64_t>;

Keys sorted(Keys keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

/// Cells of a few clusters and single ones.
Keys random_cells(Random& random, int level, std::int64_t count) {
  const std::int64_t side = std::int64_t{1} << level;
  const auto any = [&] { return static_cast<std::int32_t>(random.below(side)); };
  Keys keys;
  Coordinates centre{any(), any(), any()};
  for (std::int64_t i = 0; i < count; ++i) {
    if (random.below(10) == 0) centre = {any(), any(), any()};
    const auto near = [&](std::int32_t c) {
      return std::clamp(c + static_cast<std::int32_t>(random.below(5)) - 2, 0, static_cast<std::int32_t>(side) - 1);
    };
    keys.push_back(encode({near(centre.x), near(centre.y), near(centre.z)}));
  }
  return keys;
}

/// What `grown` must be, cell by cell.
Keys brute_force(int level, const Keys& keys, int reach) {
  const std::int32_t side = 1 << level;
  std::set<std::uint64_t> all;
  for (const std::uint64_t key : keys) {
    const Coordinates c = decode(key);
    for (std::int32_t x = std::max(c.x - reach, 0); x <= std::min(c.x + reach, side - 1); ++x)
      for (std::int32_t y = std::max(c.y - reach, 0); y <= std::min(c.y + reach, side - 1); ++y)
        for (std::int32_t z = std::max(c.z - reach, 0); z <= std::min(c.z + reach, side - 1); ++z)
          all.insert(encode({x, y, z}));
  }
  return {all.begin(), all.end()};
}

TEST(CellSet, HasItsCellsAndNoOthers) {
  Random random(1);
  for (const int level : {0, 1, 4, 6}) {
    const Keys keys = random_cells(random, level, 60);
    const CellSet set(level, keys);
    EXPECT_EQ(set.level(), level);
    EXPECT_EQ(set.keys(), sorted(keys));
    EXPECT_EQ(set.size(), static_cast<std::int64_t>(sorted(keys).size()));
    const Keys has = sorted(keys);
    for (std::uint64_t key = 0; key < std::min<std::uint64_t>(4096, std::uint64_t{1} << 3 * level); ++key)
      ASSERT_EQ(set.contains(decode(key)), std::binary_search(has.begin(), has.end(), key)) << key;
  }
}

TEST(CellSet, GrowsByWholeCellsWithinTheCube) {
  Random random(2);
  for (const int level : {0, 1, 3, 4})
    for (const int reach : {0, 1, 2, 5, 40}) {
      const Keys keys = random_cells(random, level, 12);
      const CellSet grown = CellSet(level, keys).grown(reach);
      ASSERT_EQ(grown.keys(), brute_force(level, keys, reach)) << "level " << level << ", reach " << reach;
      EXPECT_EQ(grown.size(), static_cast<std::int64_t>(grown.keys().size()));
    }
}

TEST(CellSet, GrowsInTwoStepsAsInOne) {
  Random random(3);
  const Keys keys = random_cells(random, 7, 200);
  const CellSet set(7, keys);
  EXPECT_EQ(set.grown(4).grown(9).keys(), set.grown(13).keys());
}

TEST(CellSet, OfNothingStaysEmpty) {
  const CellSet none(9, Keys{});
  EXPECT_EQ(none.size(), 0);
  EXPECT_EQ(none.grown(13).size(), 0);
  EXPECT_TRUE(none.grown(13).keys().empty());
  EXPECT_FALSE(none.grown(13).contains({0, 0, 0}));
}

TEST(CellSet, ReachesTheCornersOfTheDeepestLevel) {
  const std::int32_t last = (1 << octree::kMaxDepth) - 1;
  const CellSet set(octree::kMaxDepth, Keys{encode({0, 0, 0}), encode({last, last, last})});
  const CellSet grown = set.grown(3);
  EXPECT_EQ(grown.size(), 2 * 4 * 4 * 4);
  EXPECT_TRUE(grown.contains({3, 3, 3}));
  EXPECT_FALSE(grown.contains({4, 3, 3}));
  EXPECT_TRUE(grown.contains({last - 3, last, last - 3}));
  EXPECT_FALSE(grown.contains({last, last - 4, last}));
}

}  // namespace
}  // namespace pointskin::test
