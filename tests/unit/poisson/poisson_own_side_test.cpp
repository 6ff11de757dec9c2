// The area that a sample stands for is that on its own side of a thin wall.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "poisson/density.hpp"
#include "poisson/own_side.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

constexpr int kDepth = 7;
constexpr double kSide = 0.6;     // of the square that is sampled
constexpr double kInside = 0.15;  // borders, where a kernel reaches over, are left out

struct Sheets {
  std::vector<Vec3f> positions, normals;

  void add(test::Random& random, int count, float height, float up) {
    for (int i = 0; i < count; ++i) {
      positions.push_back({static_cast<float>(random.in(0.5 - kSide / 2, 0.5 + kSide / 2)),
                           static_cast<float>(random.in(0.5 - kSide / 2, 0.5 + kSide / 2)), height});
      normals.push_back({0, 0, up});
    }
  }
};

struct Weighed : SmallTree {
  explicit Weighed(const Sheets& sheets, bool has_signs = true) : SmallTree(sheets.positions, sheets.normals, kDepth) {
    poisson::weigh_samples(ex, tree, {1.5, false, has_signs}, samples);
  }
};

/// Mean area of the samples away from the border whose normal points up or down, finest cells^2.
double mean_area(const SmallTree& tree, bool up) {
  double sum = 0;
  int count = 0;
  for (std::int64_t i = 0; i < tree.samples.areas.size(); ++i) {
    const Vec3f p = tree.samples.positions.data()[i];
    const auto is_inside = [](float x) { return x > 0.5 - kInside && x < 0.5 + kInside; };
    if ((tree.samples.normals.data()[i].z > 0) != up || !is_inside(p.x) || !is_inside(p.y)) continue;
    sum += static_cast<double>(tree.samples.areas.data()[i]);
    ++count;
  }
  return sum / count;
}

double true_area(int samples) { return kSide * kSide * (1 << kDepth) * (1 << kDepth) / samples; }

TEST(OwnSide, OfOneSheetIsTheDensity) {
  test::Random random(1);
  Sheets sheet;
  sheet.add(random, 8000, 0.5F, 1);
  const Weighed with(sheet);
  const Weighed without(sheet, false);
  for (std::int64_t i = 0; i < 8000; ++i)
    ASSERT_FLOAT_EQ(with.samples.areas.data()[i], without.samples.areas.data()[i]) << i;
}

TEST(OwnSide, OfAThinWallThatWasSeenUnevenlyIsTheAreaOfEachSheet) {
  test::Random random(2);
  Sheets wall;
  wall.add(random, 6000, 0.5079F, 1);  // a third of a cell apart, where planes count as in the mean over a cell
  wall.add(random, 4800, 0.5053F, -1);
  const Weighed tree(wall);
  EXPECT_NEAR(mean_area(tree, true), true_area(6000), 0.1 * true_area(6000));
  const Weighed before(wall, false);  // all alike
  const double of_all = mean_area(before, false);
  EXPECT_NEAR(mean_area(before, true), of_all, 0.1 * of_all);
  EXPECT_NEAR(mean_area(tree, false), 2 * of_all, 0.3 * of_all);  // at least half of the samples around are its own
}

TEST(OwnSide, OfASingleFlippedNormalIsAFewTimesTheAreaOfTheOthers) {
  test::Random random(3);
  Sheets sheet;
  sheet.add(random, 8000, 0.5F, 1);
  sheet.positions.push_back({0.5F, 0.5F, 0.5F});
  sheet.normals.push_back({0, 0, -1});
  const double usual = mean_area(Weighed(sheet), true);
  const double of_flipped = mean_area(Weighed(sheet), false);
  EXPECT_GT(of_flipped, 1.3 * usual);
  EXPECT_LT(of_flipped, 3 * usual);  // half of the samples around, of whose number chance decides
}

}  // namespace
}  // namespace pointskin
