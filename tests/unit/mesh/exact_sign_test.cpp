// Signs of determinants against whole numbers of 128 bits, where doubles alone get them wrong.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "mesh/exact_sign.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using mesh_detail::side_of_plane;
using mesh_detail::turn;
using test::Random;
using Whole = __int128;
using WholePoint = std::array<std::int64_t, 3>;

int sign_of(Whole x) { return (x > 0) - (x < 0); }

Whole determinant(const WholePoint& a, const WholePoint& b, const WholePoint& c, const WholePoint& d) {
  Whole u[3], v[3], w[3];
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = d[i] - a[i];
  }
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0]);
}

Whole determinant(const WholePoint& a, const WholePoint& b, const WholePoint& c, std::size_t axis) {
  const std::size_t x = (axis + 1) % 3, y = (axis + 2) % 3;
  return Whole{b[x] - a[x]} * (c[y] - a[y]) - Whole{b[y] - a[y]} * (c[x] - a[x]);
}

/// The determinant as doubles have it.
double rounded_determinant(const WholePoint& a, const WholePoint& b, const WholePoint& c, const WholePoint& d) {
  double u[3], v[3], w[3];
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = static_cast<double>(b[i] - a[i]);
    v[i] = static_cast<double>(c[i] - a[i]);
    w[i] = static_cast<double>(d[i] - a[i]);
  }
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0]);
}

/// Times 2^exponent.
Vec3f as_float(const WholePoint& p, int exponent) {
  const auto value = [&](std::size_t i) { return std::ldexp(static_cast<float>(p[i]), exponent); };
  return {value(0), value(1), value(2)};
}

std::int64_t whole_below(Random& random, std::int64_t limit) { return random.below(2 * limit) - limit; }

WholePoint any_point(Random& random, std::int64_t limit) {
  return {whole_below(random, limit), whole_below(random, limit), whole_below(random, limit)};
}

/// A combination of the others with small whole factors, moved by at most one along an axis: on the plane or next to
/// it.
WholePoint near_plane(Random& random, const WholePoint& a, const WholePoint& b, const WholePoint& c) {
  const std::int64_t s = random.below(4), t = random.below(4) - 1;
  WholePoint d{};
  for (std::size_t i = 0; i < 3; ++i) d[i] = a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]);
  d[static_cast<std::size_t>(random.below(3))] += random.below(3) - 1;
  return d;
}

/// Every float holds whole numbers below 2^24.
constexpr std::int64_t kLimit = std::int64_t{1} << 20;

TEST(SideOfPlane, IsThatOfWholeNumbersNextToThePlane) {
  int on_plane = 0, rounded_wrong = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    Random random(seed);
    const WholePoint a = any_point(random, kLimit), b = any_point(random, kLimit), c = any_point(random, kLimit);
    const WholePoint d = near_plane(random, a, b, c);
    const int expected = sign_of(determinant(a, b, c, d));
    const int exponent = static_cast<int>(random.below(230)) - 130;  // down to floats without leading bits
    const auto f = [exponent](const WholePoint& p) { return as_float(p, exponent); };
    ASSERT_EQ(side_of_plane(f(a), f(b), f(c), f(d)), expected) << "seed " << seed;
    ASSERT_EQ(side_of_plane(f(b), f(a), f(c), f(d)), -expected) << "seed " << seed;
    ASSERT_EQ(side_of_plane(f(d), f(b), f(c), f(a)), -expected) << "seed " << seed;
    if (expected == 0) ++on_plane;
    const double rounded = rounded_determinant(a, b, c, d);
    if ((rounded > 0) - (rounded < 0) != expected) ++rounded_wrong;
  }
  EXPECT_GT(on_plane, 1000);
  EXPECT_GT(rounded_wrong, 100);  // or the test would not need exact arithmetic
}

TEST(SideOfPlane, IsThatOfWholeNumbersForCoordinatesOfAllSizes) {
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    Random random(seed);
    const auto size = [&] { return std::int64_t{1} << (1 + random.below(23)); };
    const WholePoint a = any_point(random, size()), b = any_point(random, size());
    const WholePoint c = any_point(random, size()), d = any_point(random, size());
    ASSERT_EQ(side_of_plane(as_float(a, 0), as_float(b, 0), as_float(c, 0), as_float(d, 0)),
              sign_of(determinant(a, b, c, d)))
        << "seed " << seed;
  }
}

/// Axes of different scales: sides stay, and no power of two has all coordinates for whole multiples below 2^41.
TEST(SideOfPlane, DoesNotDependOnTheScalesOfTheAxes) {
  for (std::uint64_t seed = 1; seed <= 10'000; ++seed) {
    Random random(seed);
    const WholePoint a = any_point(random, kLimit), b = any_point(random, kLimit), c = any_point(random, kLimit);
    const WholePoint d = near_plane(random, a, b, c);
    std::array<int, 3> exponents{};
    for (int& e : exponents) e = static_cast<int>(random.below(160)) - 80;
    const auto f = [&](const WholePoint& p) -> Vec3f {
      return {as_float(p, exponents[0]).x, as_float(p, exponents[1]).y, as_float(p, exponents[2]).z};
    };
    ASSERT_EQ(side_of_plane(f(a), f(b), f(c), f(d)), sign_of(determinant(a, b, c, d))) << "seed " << seed;
  }
}

TEST(SideOfPlane, SeesATinyStepFromAHugePlane) {
  // Differences lose the step: 1e30 + 1e-30 is 1e30 in double.
  const Vec3f a{1e30F, 0, 0}, b{0, 1e30F, 0}, c{-1e30F, -1e30F, 0};
  EXPECT_EQ(side_of_plane(a, b, c, {0, 0, 1e-30F}), 1);
  EXPECT_EQ(side_of_plane(a, b, c, {0, 0, -1e-30F}), -1);
  EXPECT_EQ(side_of_plane(a, b, c, {1e30F, 1e-30F, 0}), 0);
  const Vec3f d{1e30F, 1e-30F, 0}, e{1e-30F, 1e30F, 0};  // x + y = 1e30 + 1e-30
  EXPECT_EQ(side_of_plane(d, e, {1e30F, 1e-30F, 1}, {1e30F, 0, 0}), side_of_plane(d, e, {1e30F, 1e-30F, 1}, {0, 0, 0}));
}

TEST(SideOfPlane, IsNoneWhereThreePointsAreOnALine) {
  EXPECT_EQ(side_of_plane({1, 1, 1}, {2, 2, 2}, {4, 4, 4}, {0, 1, 0}), 0);
  EXPECT_EQ(side_of_plane({1, 1, 1}, {1, 1, 1}, {4, 5, 4}, {0, 1, 0}), 0);
}

TEST(Turn, IsThatOfWholeNumbersNextToTheLine) {
  int on_line = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    Random random(seed);
    const WholePoint a = any_point(random, kLimit), b = any_point(random, kLimit);
    const WholePoint c = near_plane(random, a, b, b);
    const int exponent = static_cast<int>(random.below(230)) - 130;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int expected = sign_of(determinant(a, b, c, axis));
      const auto f = [exponent](const WholePoint& p) { return as_float(p, exponent); };
      ASSERT_EQ(turn(f(a), f(b), f(c), static_cast<int>(axis)), expected) << "seed " << seed << ", axis " << axis;
      ASSERT_EQ(turn(f(c), f(b), f(a), static_cast<int>(axis)), -expected) << "seed " << seed << ", axis " << axis;
      if (expected == 0) ++on_line;
    }
  }
  EXPECT_GT(on_line, 1000);
}

TEST(Turn, LeavesOneCoordinateOut) {
  const Vec3f o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  EXPECT_EQ(turn(o, y, z, 0), 1);
  EXPECT_EQ(turn(o, z, x, 1), 1);
  EXPECT_EQ(turn(o, x, y, 2), 1);
  EXPECT_EQ(turn(o, x, y, 0), 0);
}

}  // namespace
}  // namespace pointskin
