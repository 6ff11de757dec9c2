// Exact sums against sums that are known, from all orders and parts. That every space gives the same bits: primitives_tests.hpp.
#include "exec/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "exec/this_space.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

constexpr int kFraction = 64;

double sum_of(const std::vector<double>& terms, int fraction = kFraction) {
  exec::Cpu ex(2);
  return exec::exact_sum(ex, "test", static_cast<std::int64_t>(terms.size()),
                         exec::LoadValue<double>{{terms.data(), static_cast<std::int64_t>(terms.size())}}, fraction);
}

exec::ExactSum units_of(const std::vector<double>& terms, std::size_t begin, std::size_t end) {
  exec::ExactSum sum;
  for (std::size_t i = begin; i < end; ++i) sum = exec::AddExactly{}(sum, exec::exact_term(terms[i], kFraction));
  return sum;
}

bool same(const exec::ExactSum& a, const exec::ExactSum& b) { return a.units == b.units && a.outside == b.outside; }

/// Terms of both signs and of sizes from 2^-30 to 2^20.
std::vector<double> mixed_terms(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> terms;
  for (std::size_t i = 0; i < n; ++i)
    terms.push_back(std::ldexp(random.in(-1, 1), static_cast<int>(random.in(-30, 20))));
  return terms;
}

TEST(ExactSum, IsOneInAllOrders) {
  std::vector<double> terms = mixed_terms(10'000, 1);
  const double sum = sum_of(terms);
  std::sort(terms.begin(), terms.end());
  EXPECT_EQ(sum_of(terms), sum);
  std::reverse(terms.begin(), terms.end());
  EXPECT_EQ(sum_of(terms), sum);
  std::sort(terms.begin(), terms.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  EXPECT_EQ(sum_of(terms), sum);
}

TEST(ExactSum, IsOneFromAllParts) {
  const std::vector<double> terms = mixed_terms(1'000, 2);
  const exec::ExactSum whole = units_of(terms, 0, terms.size());
  for (std::size_t cut = 0; cut <= terms.size(); cut += 37)
    EXPECT_TRUE(same(exec::AddExactly{}(units_of(terms, cut, terms.size()), units_of(terms, 0, cut)), whole)) << cut;
}

TEST(ExactSum, IsTheNearestDoubleOfTheTrueSum) {
  Random random(3);
  std::vector<double> terms;
  std::int64_t true_sum = 0;  // in units of 2^-20
  for (int i = 0; i < 5'000; ++i) {
    const auto units = static_cast<std::int64_t>(random.in(-0x1p45, 0x1p45));
    true_sum += units;
    terms.push_back(std::ldexp(static_cast<double>(units), -20));
  }
  EXPECT_EQ(sum_of(terms), std::ldexp(static_cast<double>(true_sum), -20));
}

TEST(ExactSum, KeepsWhatSumsOfDoublesLose) {
  EXPECT_EQ(sum_of({0x1p60, 1, -0x1p60}), 1);
  EXPECT_EQ(sum_of({1, 0x1p-60, -1}), 0x1p-60);
  EXPECT_EQ(sum_of({1, -1}), 0);
  EXPECT_EQ(sum_of({0, -0.0}), 0);
}

TEST(ExactSum, ChoosesItsUnitByTheLargestTermWhereTheGivenOneDoesNotDo) {
  EXPECT_EQ(sum_of({1e300, 2e300, 1e300}), 4e300);
  EXPECT_EQ(sum_of({3e-300, 3e-300}), 6e-300);
  EXPECT_DOUBLE_EQ(sum_of({1e38, -3e37, 2e30}), 1e38 - 3e37 + 2e30);
  EXPECT_EQ(sum_of({std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::denorm_min()}),
            2 * std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(sum_of({std::numeric_limits<double>::max()}), std::numeric_limits<double>::max());
  for (const int fraction : {-200, 0, 64, 200}) EXPECT_EQ(sum_of({0.75, 0.5, -0.125}, fraction), 1.125) << fraction;
}

TEST(ExactSum, IsNotANumberIfATermIsNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {infinity, -infinity, nan, -nan})
    for (std::size_t place = 0; place < 3; ++place) {
      std::vector<double> terms{1, 2, 3};
      terms[place] = wrong;
      EXPECT_TRUE(std::isnan(sum_of(terms))) << wrong << " at " << place;
    }
}

TEST(ExactSum, HasRoomFor2To32OfTheLargestTerms) {
  const double largest = std::nextafter(0x1p31, 0);  // 2^95 units of 2^-64 are one too many
  const exec::ExactSum term = exec::exact_term(largest, kFraction);
  EXPECT_EQ(term.outside, 0);
  EXPECT_EQ(exec::exact_term(0x1p31, kFraction).outside, 1);
  exec::ExactSum sum = term;
  for (int i = 0; i < 32; ++i) sum = exec::AddExactly{}(sum, sum);
  EXPECT_EQ(sum.value(kFraction), std::ldexp(largest, 32));
  exec::ExactSum below = exec::exact_term(-largest, kFraction);
  for (int i = 0; i < 32; ++i) below = exec::AddExactly{}(below, below);
  EXPECT_EQ(below.value(kFraction), -std::ldexp(largest, 32));
}

TEST(ExactSum, IsReliableWhereWhatWasCutOffIsSmall) {
  exec::ExactSum sum;
  sum.units = exec::ExactSum::Whole{1} << 50;
  EXPECT_TRUE(sum.reliable(1 << 10));
  EXPECT_FALSE(sum.reliable((1 << 10) + 1));
  sum.units = -sum.units;
  EXPECT_TRUE(sum.reliable(1 << 10));
  sum.outside = 1;
  EXPECT_FALSE(sum.reliable(1));
}

}  // namespace
}  // namespace pointskin::test
