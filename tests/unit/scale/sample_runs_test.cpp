// The samples that a block takes, against a look at each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scale/sample_runs.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using scale::CellSet;
using scale::runs_in;
using scale::SampleRun;

/// Samples of a level's cells, sorted.
struct Sorted {
  std::vector<std::uint64_t> cells;       ///< that hold samples
  std::vector<std::int64_t> first;        ///< of each, and the number of all
  std::vector<std::uint64_t> of_samples;  ///< the cell of every sample
};

Sorted random_samples(Random& random, int level, std::int64_t count) {
  Sorted sorted;
  for (std::int64_t i = 0; i < count; ++i)
    sorted.of_samples.push_back(static_cast<std::uint64_t>(random.below(std::int64_t{1} << 3 * level)));
  std::sort(sorted.of_samples.begin(), sorted.of_samples.end());
  for (std::size_t i = 0; i < sorted.of_samples.size(); ++i) {
    if (i > 0 && sorted.of_samples[i] == sorted.of_samples[i - 1]) continue;
    sorted.cells.push_back(sorted.of_samples[i]);
    sorted.first.push_back(static_cast<std::int64_t>(i));
  }
  sorted.first.push_back(count);
  return sorted;
}

TEST(SampleRuns, HaveTheSamplesOfTheCellsAndNoOthers) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const int level = 2 + static_cast<int>(random.below(2));
    const Sorted sorted = random_samples(random, level, 1 + random.below(300));
    std::vector<std::uint64_t> some;
    for (const std::uint64_t cell : sorted.cells)
      if (random.below(8) == 0) some.push_back(cell);
    const CellSet set(level, some);
    std::vector<bool> expected;
    for (const std::uint64_t cell : sorted.of_samples) expected.push_back(set.contains(octree::decode(cell)));
    std::vector<bool> taken(sorted.of_samples.size(), false);
    std::int64_t before = -1;
    for (const SampleRun& run : runs_in(set, sorted.cells, sorted.first)) {
      ASSERT_LT(before, run.begin) << "runs touch or do not ascend";
      ASSERT_LT(run.begin, run.end);
      for (std::int64_t i = run.begin; i < run.end; ++i) taken[static_cast<std::size_t>(i)] = true;
      before = run.end;
    }
    ASSERT_EQ(taken, expected);
  }
}

TEST(SampleRuns, OfNoCellsAreNone) {
  Random random(2);
  const Sorted sorted = random_samples(random, 3, 50);
  EXPECT_TRUE(runs_in(CellSet(3, std::vector<std::uint64_t>{}), sorted.cells, sorted.first).empty());
  const std::vector<std::int64_t> none{0};
  EXPECT_TRUE(runs_in(CellSet(3, sorted.cells), {}, none).empty());
}

}  // namespace
}  // namespace pointskin::test
