// Cuts against the best of all cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "scale/block_cuts.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using scale::cut_evenly;
using Loads = std::vector<std::int64_t>;

std::int64_t heaviest(const Loads& loads, const std::vector<std::int64_t>& begins) {
  std::int64_t most = 0;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i)
    most = std::max(most, std::accumulate(loads.begin() + begins[i], loads.begin() + begins[i + 1], std::int64_t{0}));
  return most;
}

/// The lightest heaviest run of cells `first` on in `blocks` runs.
std::int64_t best(const Loads& loads, std::size_t first, int blocks) {
  if (blocks == 1)
    return std::accumulate(loads.begin() + static_cast<std::ptrdiff_t>(first), loads.end(), std::int64_t{0});
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  std::int64_t run = 0;
  for (std::size_t end = first; end <= loads.size(); ++end) {
    least = std::min(least, std::max(run, best(loads, end, blocks - 1)));
    if (end < loads.size()) run += loads[end];
  }
  return least;
}

void expect_cuts(const Loads& loads, const std::vector<std::int64_t>& begins, int blocks) {
  ASSERT_EQ(begins.size(), static_cast<std::size_t>(blocks) + 1);
  EXPECT_EQ(begins.front(), 0);
  EXPECT_EQ(begins.back(), static_cast<std::int64_t>(loads.size()));
  EXPECT_TRUE(std::is_sorted(begins.begin(), begins.end()));
}

TEST(BlockCuts, MakeTheHeaviestBlockAsLightAsCanBe) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    Loads loads(random.below(9));
    for (std::int64_t& load : loads) load = static_cast<std::int64_t>(random.below(random.below(2) == 0 ? 4 : 100));
    const int blocks = 1 + static_cast<int>(random.below(4));
    const std::vector<std::int64_t> begins = cut_evenly(loads, blocks);
    expect_cuts(loads, begins, blocks);
    EXPECT_EQ(heaviest(loads, begins), best(loads, 0, blocks));
  }
}

TEST(BlockCuts, OfEqualCellsAreEven) {
  const Loads loads(700, 5);
  const std::vector<std::int64_t> begins = cut_evenly(loads, 7);
  for (std::size_t i = 0; i < begins.size(); ++i) EXPECT_EQ(begins[i], static_cast<std::int64_t>(100 * i));
}

TEST(BlockCuts, LeaveBlocksEmptyWhereThereAreTooFewCells) {
  const Loads loads{3, 4};
  const std::vector<std::int64_t> begins = cut_evenly(loads, 4);
  expect_cuts(loads, begins, 4);
  EXPECT_EQ(heaviest(loads, begins), 4);
  expect_cuts({}, cut_evenly({}, 3), 3);
  expect_cuts({0, 0, 0}, cut_evenly(Loads{0, 0, 0}, 2), 2);
}

TEST(BlockCuts, HoldForLoadsWhoseSumIsHuge) {
  const std::int64_t huge = std::numeric_limits<std::int64_t>::max() / 8;
  const Loads loads(8, huge);
  const std::vector<std::int64_t> begins = cut_evenly(loads, 4);
  expect_cuts(loads, begins, 4);
  EXPECT_EQ(heaviest(loads, begins), 2 * huge);
}

}  // namespace
}  // namespace pointskin::test
