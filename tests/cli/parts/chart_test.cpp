// Charts: the choice of ticks, and SVG that stays well-formed whatever the names hold.
#include "bench/chart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace pointskin::cli {
namespace {

using Values = std::vector<double>;

void expect_ticks(double least, double most, const Values& expected) {
  const Values ticks = log_ticks(least, most);
  ASSERT_EQ(ticks.size(), expected.size()) << least << " " << most;
  for (std::size_t i = 0; i < ticks.size(); ++i) EXPECT_NEAR(ticks[i], expected[i], 1e-9 * expected[i]);
}

TEST(LogTicks, AreOneTwoAndFiveOverAShortRange) {
  expect_ticks(3, 40, {2, 5, 10, 20, 50});
  expect_ticks(0.21, 0.9, {0.2, 0.5, 1});
}

TEST(LogTicks, StartAndEndAtTheRangeWhereItIsRound) {
  expect_ticks(10, 100, {10, 20, 50, 100});
  expect_ticks(0.001, 0.002, {0.001, 0.002});
  expect_ticks(1000, 5000, {1000, 2000, 5000});
}

TEST(LogTicks, ArePowersOfTenOverALongRange) { expect_ticks(3, 40000, {1, 10, 100, 1000, 10000, 100000}); }

TEST(LogTicks, SkipPowersOfTenOverAVeryLongRange) {
  expect_ticks(1, 1e12, {1, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12});
  expect_ticks(1, 1e13, {1, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12, 1e14});
}

TEST(LogTicks, CoverASingleValue) {
  expect_ticks(7, 7, {5, 10});
  expect_ticks(10, 10, {10, 20});
}

TEST(LogTicks, CoverEveryRangeWithTwoToEightAscendingValues) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> exponent(-12, 12);
  for (int i = 0; i < 10000; ++i) {
    double least = std::pow(10, exponent(random)), most = std::pow(10, exponent(random));
    if (least > most) std::swap(least, most);
    const Values ticks = log_ticks(least, most);
    SCOPED_TRACE(testing::Message() << least << " to " << most << ", seed " << kSeed);
    ASSERT_GE(ticks.size(), 2U);
    ASSERT_LE(ticks.size(), 8U);
    EXPECT_LE(ticks.front(), least * (1 + 1e-6));
    EXPECT_GE(ticks.back(), most * (1 - 1e-6));
    for (std::size_t t = 1; t < ticks.size(); ++t) EXPECT_LT(ticks[t - 1], ticks[t]);
  }
}

TEST(Svg, EscapesNames) {
  Chart chart = {"a < b & \"c\"", "x\x01\xff", {{1, "1"}, {10, "10"}}, {{1, "1"}, {10, "10"}}, {}};
  chart.series = {{"<script>", true, {{1, 10}, {10, 1}}}};
  const std::string svg = to_svg({chart});
  EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  EXPECT_EQ(svg.find('\x01'), std::string::npos);
  EXPECT_EQ(svg.find('\xff'), std::string::npos);
}

TEST(Svg, PutsTheEndsOfTheAxesAtTheCorners) {
  Chart chart = {"t", "x", {{1, "1"}, {100, "100"}}, {{1, "1"}, {100, "100"}}, {}};
  chart.series = {{"s", false, {{1, 1}, {10, 10}, {100, 100}}}};
  EXPECT_NE(to_svg({chart}).find("M70.0 380.0L300.0 215.0L530.0 50.0"), std::string::npos);
}

}  // namespace
}  // namespace pointskin::cli
