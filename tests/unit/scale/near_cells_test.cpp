// Cells that may hold the sample nearest to a point, against all samples.
#include "scale/near_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "octree/keys.hpp"
#include "octree/walk.hpp"
#include "scale/far_points.hpp"
#include "support/shapes.hpp"

namespace pointskin::scale {
namespace {

struct Samples {
  std::vector<Vec3f> positions;
  std::vector<std::uint64_t> cells;  // of a level, ascending, each once
};

std::uint64_t cell_of(const Vec3f& p, int level) { return octree::cell_key(octree::point_key(p.x, p.y, p.z), level); }

Samples samples_in(int level, int count, test::Random& random) {
  Samples samples;
  const auto coordinate = [&] {
    return static_cast<float>(random.below(1 << 12)) / (1 << 12);
  };  // some as near as others
  for (int i = 0; i < count; ++i) {
    samples.positions.push_back({coordinate(), coordinate(), coordinate()});
    samples.cells.push_back(cell_of(samples.positions.back(), level));
  }
  std::ranges::sort(samples.cells);
  samples.cells.erase(std::unique(samples.cells.begin(), samples.cells.end()), samples.cells.end());
  return samples;
}

TEST(NearCells, HoldEverySampleThatIsNearest) {
  test::Random random(1);
  for (const int level : {0, 1, 4, 7}) {
    for (const int count : {1, 2, 30, 400}) {
      const Samples samples = samples_in(level, count, random);
      const NearCells cells(level, samples.cells);
      for (int query = 0; query < 100; ++query) {
        const auto coordinate = [&] { return static_cast<float>(random.below(257)) / 256; };
        const Vec3f q{coordinate(), coordinate(), coordinate()};
        float least = std::numeric_limits<float>::infinity();
        for (const Vec3f& p : samples.positions) least = std::min(least, octree::squared_distance(q, p));
        const std::vector<std::int64_t> found = cells.around(q);
        EXPECT_TRUE(std::ranges::is_sorted(found));
        for (const Vec3f& p : samples.positions) {
          if (octree::squared_distance(q, p) > least) continue;
          const auto place = std::ranges::lower_bound(samples.cells, cell_of(p, level)) - samples.cells.begin();
          EXPECT_TRUE(std::ranges::binary_search(found, place)) << level << ", " << count;
        }
      }
    }
  }
}

/// Of a wall of cells, those around the foot of a point.
TEST(NearCells, AreFew) {
  constexpr int kLevel = 7, kSide = 1 << kLevel;
  std::vector<std::uint64_t> wall;
  for (std::int32_t y = 0; y < kSide; ++y)
    for (std::int32_t z = 0; z < kSide; ++z) wall.push_back(octree::encode({0, y, z}));
  std::ranges::sort(wall);
  const NearCells cells(kLevel, wall);
  EXPECT_LE(cells.around({0.001F, 0.5F, 0.5F}).size(), 16U);
  EXPECT_LE(cells.around({0.25F, 0.5F, 0.5F}).size(), 400U);  // a disc of twice the square root of 32 cells
}

TEST(NearCells, AreNoneWhereThereIsNone) { EXPECT_TRUE(NearCells(5, {}).around({0.5F, 0.5F, 0.5F}).empty()); }

TEST(FarPoints, AreSearchedAmongPartsOfAllSamples) {
  const auto cut = [](std::vector<SampleRun> runs, std::int64_t most) {
    std::vector<std::vector<std::int64_t>> parts;
    for (const std::vector<SampleRun>& part : cut_into_parts(runs, most)) {
      parts.emplace_back();
      for (const SampleRun& run : part)
        for (std::int64_t sample = run.begin; sample < run.end; ++sample) parts.back().push_back(sample);
    }
    return parts;
  };
  using Parts = std::vector<std::vector<std::int64_t>>;
  EXPECT_EQ(cut({{3, 5}, {7, 8}, {10, 14}}, 3), (Parts{{3, 4, 7}, {10, 11, 12}, {13}}));
  EXPECT_EQ(cut({{3, 5}}, 9), (Parts{{3, 4}}));
  EXPECT_EQ(cut({}, 9), Parts{});
}

}  // namespace
}  // namespace pointskin::scale
