// Middle and spread.
#include "statistics.hpp"

#include <gtest/gtest.h>

namespace pointskin::cli {
namespace {

TEST(SpreadOf, IsTheMiddleAndTheEndsInAnyOrder) {
  const Spread odd = spread_of(std::vector<double>{5, 1, 3});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 5);
  EXPECT_EQ(spread_of(std::vector<double>{7}).median, 7);
}

TEST(SpreadOf, TakesTheMeanOfTheTwoInTheMiddle) { EXPECT_EQ(spread_of(std::vector<double>{8, 1, 4, 2}).median, 3); }

}  // namespace
}  // namespace pointskin::cli
