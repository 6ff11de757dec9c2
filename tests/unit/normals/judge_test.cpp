// Choices of signs against all combinations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "normals/disjoint_sets.hpp"
#include "normals/judge.hpp"
#include "support/shapes.hpp"

namespace pointskin::normals {
namespace {

double sum_of(const Couplings& c, const std::vector<int>& signs) {
  double sum = 0;
  for (std::size_t a = 0; a < c.count; ++a)
    for (std::size_t b = 0; b < c.count; ++b)
      if (a != b) sum += signs[a] * signs[b] * (c(a, b) + c(b, a)) / 2;
  return sum;
}

Couplings random_couplings(std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  Couplings c{count, std::vector<double>(count * count)};
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b) c.values[a * count + b] = a == b ? 1 : random.in(-0.5, 0.5);
  return c;
}

TEST(ChooseSigns, FindsTheBestOfAllCombinations) {
  constexpr std::size_t kCount = 6;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Couplings c = random_couplings(kCount, seed);
    for (double& value : c.values)
      if (value > -0.05 && value < 0.05) value = 0.05;  // none are taken for none
    for (std::size_t a = 0; a < kCount; ++a)
      for (std::size_t b = 0; b < a; ++b) c.values[a * kCount + b] = c.values[b * kCount + a];
    std::vector<int> signs(kCount, 1);
    choose_signs(c, std::vector<bool>(kCount, false), signs);
    double best = -1e9;
    for (std::uint32_t code = 0; code < 1U << kCount; ++code) {
      std::vector<int> other(kCount);
      for (std::size_t a = 0; a < kCount; ++a) other[a] = (code >> a & 1) != 0 ? -1 : 1;
      best = std::max(best, sum_of(c, other));
    }
    EXPECT_NEAR(sum_of(c, signs), best, 1e-9);
  }
}

TEST(ChooseSigns, LeavesFixedOnesAndWhatDoesNotInteract) {
  Couplings c{3, {1, -0.5, 0.001, -0.5, 1, 0, 0.001, 0, 1}};
  std::vector<int> signs = {1, 1, -1};
  choose_signs(c, {true, false, false}, signs);
  EXPECT_EQ(signs, (std::vector<int>{1, -1, -1}));
}

TEST(ChooseSigns, ImprovesManyStepByStep) {
  const Couplings c = random_couplings(20, 42);
  std::vector<int> signs(20, 1);
  const double before = sum_of(c, signs);
  choose_signs(c, std::vector<bool>(20, false), signs);
  EXPECT_GT(sum_of(c, signs), before);
}

TEST(ChooseSides, TurnsCavitiesInsideSolids) {
  // Sphere in sphere in sphere: outside of itself a sphere's field is 0, inside 1, on it 1/2.
  Sides sides(3);
  sides.means = {0.5, 1, 1, 0, 0.5, 1, 0, 0, 0.5};
  sides.areas = {4, 2, 1};
  std::vector<int> signs = {-1, -1, -1};
  choose_sides(sides, {false, false, false}, signs);
  EXPECT_EQ(signs, (std::vector<int>{1, -1, 1}));
}

TEST(ChooseSides, KeepsFixedSides) {
  Sides sides(2);
  sides.means = {0.5, 0, 0, 0.5};  // apart
  sides.areas = {1, 1};
  std::vector<int> signs = {-1, -1};
  choose_sides(sides, {true, false}, signs);
  EXPECT_EQ(signs, (std::vector<int>{-1, 1}));
}

TEST(ChooseSides, GivesTheSheetsOfAThinWallOppositeSides) {
  // Two sheets, each with its lower side at -1/4 and its upper one at 1/4 beyond the rims' effect.
  Sides sides(2);
  sides.means = {0.02, -0.27, 0.25, -0.01};
  sides.areas = {1, 1};
  std::vector<int> signs = {1, 1};
  choose_sides(sides, {false, false}, signs);
  EXPECT_EQ(signs, (std::vector<int>{-1, 1}));
}

TEST(ChooseSides, FollowsTiesWhereTheFieldSaysNothing) {
  Sides sides(2);
  sides.means = {0, 0.01, 0.02, 0};
  sides.areas = {1, 1};
  sides.ties = {0, 0, 0.05, 0};
  for (const std::vector<int>& start : {std::vector<int>{1, 1}, std::vector<int>{1, -1}}) {
    std::vector<int> signs = start;
    choose_sides(sides, {false, false}, signs);
    EXPECT_EQ(signs[0] * signs[1], start[0] * start[1]);
  }
}

TEST(DisjointSets, AreNamedByTheirSmallestMembers) {
  DisjointSets sets(6);
  sets.unite(4, 2);
  sets.unite(5, 4);
  sets.unite(1, 3);
  EXPECT_EQ(sets.root(5), 2U);
  EXPECT_EQ(sets.root(3), 1U);
  const DisjointSets::Numbers numbers = sets.numbers();
  EXPECT_EQ(numbers.count, 3U);
  EXPECT_EQ(numbers.of, (std::vector<std::int32_t>{0, 1, 2, 1, 2, 2}));
}

}  // namespace
}  // namespace pointskin::normals
