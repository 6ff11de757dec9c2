// The 27-point stencils against element matrices integrated here by Gauss quadrature, and what every such operator must
// do.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "poisson/splat_kernel.hpp"
#include "poisson/stencil.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using poisson::AxisSide;
using poisson::kAxisRows;
using Index = std::array<std::size_t, 3>;

constexpr double kTolerance = 1e-14;

/// Calls f for all of {0, 1, 2}^3: the sides of a corner, or its 27 neighbours.
template <class F>
void for_all_triples(const F& f) {
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c) f(Index{a, b, c});
}

bool has_cell(std::size_t side, int below) {
  return below != 0 ? side != static_cast<std::size_t>(AxisSide::lower_face)
                    : side != static_cast<std::size_t>(AxisSide::upper_face);
}

/// Value of one-dimensional hat `end` of the unit cell, or of its derivative.
double hat(int end, double x, bool derivative) {
  if (derivative) return end != 0 ? 1 : -1;
  return end != 0 ? x : 1 - x;
}

/// Integral over the unit cell of the product over axes of hat i (differentiated along di) and hat j (along dj), -1:
/// not. Two Gauss points an axis are exact for these products of degree 2.
double element_integral(int i, int di, int j, int dj) {
  double product = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int bi = i >> (2 - axis) & 1;
    const int bj = j >> (2 - axis) & 1;
    double sum = 0;
    for (const double x : {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)})
      sum += 0.5 * hat(bi, x, axis == di) * hat(bj, x, axis == dj);
    product *= sum;
  }
  return product;
}

/// Sum of element_integral over the cells around a corner with these sides, for its neighbour at offset `at` - 1.
template <class Integral>
double assembled(const Index& sides, const Index& at, const Integral& integral) {
  double sum = 0;
  for (int cell = 0; cell < 8; ++cell) {  // bit set: the cell lies below the corner along that axis
    int i = 0;
    int j = 0;
    bool exists = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int below = cell >> (2 - axis) & 1;
      const int end = static_cast<int>(at[axis]) - 1 + below;  // of the neighbour in this cell
      exists = exists && has_cell(sides[axis], below) && (end == 0 || end == 1);
      i = i << 1 | below;
      j = j << 1 | (end & 1);
    }
    if (exists) sum += integral(i, j);
  }
  return sum;
}

TEST(Stencil, LaplacianIsTheIntegralOfGradientProductsAtEveryCombinationOfCubeFaces) {
  for_all_triples([](const Index& sides) {
    for_all_triples([&](const Index& at) {
      const double expected = assembled(sides, at, [](int i, int j) {
        return element_integral(i, 0, j, 0) + element_integral(i, 1, j, 1) + element_integral(i, 2, j, 2);
      });
      EXPECT_NEAR(poisson::laplacian_coefficient(sides, at), expected, kTolerance);
    });
  });
}

// Central difference along the axis, mean over three corners along the two others: integral V . grad phi falls where V
// grows.
TEST(Stencil, DivergenceIsTheSlopeAlongTheAxisAveragedAcrossIt) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for_all_triples([&](const Index& at) {
      const double slope = (1 - static_cast<double>(at[axis])) / 2;
      EXPECT_NEAR(poisson::divergence_coefficient(axis, at), slope / 9, kTolerance);
    });
}

TEST(Stencil, SpreadRowsSumToTheIntegralOfTheirHat) {
  const std::array<double, 3> integral{1, 0.5, 0.5};
  for (std::size_t side = 0; side < 3; ++side)
    EXPECT_NEAR(kAxisRows.spread[side][0] + kAxisRows.spread[side][1] + kAxisRows.spread[side][2], integral[side],
                kTolerance);
}

TEST(Stencil, MassRowsSumToTheIntegralOfTheirHat) {   // the hats are a partition of unity
  const std::array<double, 3> integral{1, 0.5, 0.5};  // AxisSide: inside, lower_face, upper_face
  for (std::size_t side = 0; side < 3; ++side)
    EXPECT_NEAR(kAxisRows.mass[side][0] + kAxisRows.mass[side][1] + kAxisRows.mass[side][2], integral[side],
                kTolerance);
}

TEST(Stencil, LaplacianOfAConstantIsZeroAtEveryCombinationOfCubeFaces) {
  for_all_triples([](const Index& sides) {
    double sum = 0;
    for_all_triples([&](const Index& at) { sum += poisson::laplacian_coefficient(sides, at); });
    EXPECT_NEAR(sum, 0, kTolerance) << sides[0] << sides[1] << sides[2];
  });
}

TEST(Stencil, DivergenceOfAConstantFieldIsZero) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double sum = 0;
    for_all_triples([&](const Index& at) { sum += poisson::divergence_coefficient(axis, at); });
    EXPECT_NEAR(sum, 0, kTolerance);
  }
}

// integral grad x . grad phi = boundary integral of phi times the normal's x: nothing inside, and minus or plus the
// hat's integral over the face at the lower or upper face, halved for each of the other axes that is at a face as well.
TEST(Stencil, LaplacianOfALinearFunctionIsItsFluxThroughTheFace) {
  const std::array<double, 3> outward{0, -1, 1};
  const std::array<double, 3> integral{1, 0.5, 0.5};
  for_all_triples([&](const Index& sides) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for_all_triples([&](const Index& at) {
        sum += poisson::laplacian_coefficient(sides, at) * (static_cast<double>(at[axis]) - 1);
      });
      const double flux = outward[sides[axis]] * integral[sides[(axis + 1) % 3]] * integral[sides[(axis + 2) % 3]];
      EXPECT_NEAR(sum, flux, kTolerance) << sides[0] << sides[1] << sides[2] << " axis " << axis;
    }
  });
}

TEST(Stencil, DivergenceMatchesTheLaplacianOfALinearFunctionInside) {
  // V = (x, 0, 0): integral x dphi/dx = -integral phi = -1.
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t along = 0; along < 3; ++along) {
      double sum = 0;
      for_all_triples([&](const Index& at) {
        sum += poisson::divergence_coefficient(axis, at) * (static_cast<double>(at[along]) - 1);
      });
      EXPECT_NEAR(sum, axis == along ? -1 : 0, kTolerance);
    }
}

TEST(Stencil, LaplacianIsSymmetricBetweenACornerOnAFaceAndItsInnerNeighbour) {
  for_all_triples([](const Index& at) {
    // Corner p at coordinate 0 of an axis that has a neighbour q at 1; p at 1 inside otherwise.
    Index sides_p{};
    Index sides_q{};
    Index back{};
    for (std::size_t a = 0; a < 3; ++a) {
      sides_p[a] = static_cast<std::size_t>(at[a] == 2 ? AxisSide::lower_face : AxisSide::inside);
      sides_q[a] = static_cast<std::size_t>(at[a] == 0 ? AxisSide::lower_face : AxisSide::inside);
      back[a] = 2 - at[a];
    }
    EXPECT_NEAR(poisson::laplacian_coefficient(sides_p, at), poisson::laplacian_coefficient(sides_q, back), kTolerance);
  });
}

TEST(Stencil, LaplacianHasNoEigenvalueBeyondItsBound) {
  // Symbol of the tensor product: 1-D symbols of K and M at frequency t are 2 - 2 cos t and (2 + cos t) / 3.
  const auto k = [](double t) { return 2 - 2 * std::cos(t); };
  const auto m = [](double t) { return (2 + std::cos(t)) / 3; };
  double largest = 0;
  constexpr int kSteps = 64;
  for (int a = 0; a <= kSteps; ++a)
    for (int b = 0; b <= kSteps; ++b)
      for (int c = 0; c <= kSteps; ++c) {
        const double x = std::numbers::pi * a / kSteps;
        const double y = std::numbers::pi * b / kSteps;
        const double z = std::numbers::pi * c / kSteps;
        const double symbol = k(x) * m(y) * m(z) + m(x) * k(y) * m(z) + m(x) * m(y) * k(z);
        EXPECT_GE(symbol, 0);
        largest = std::max(largest, symbol);
      }
  EXPECT_NEAR(largest, static_cast<double>(poisson::kLargestEigenvalue), 1e-12);  // reached: the bound is tight
}

// ---- Splat kernels

/// Sums of the kernel over whole-number places, weighted by 1 and by the place.
template <class Kernel>
void expect_reproduces_linear_functions() {
  const Kernel kernel;
  test::Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(random.in(0, 1));
    double sum = 0;
    double moment = 0;
    for (int corner = -3; corner <= 4; ++corner) {
      const double weight = kernel(x - static_cast<float>(corner));
      EXPECT_GE(weight, 0);
      sum += weight;
      moment += weight * corner;
    }
    EXPECT_NEAR(sum, 1, 1e-6) << "x = " << x;
    EXPECT_NEAR(moment, x, 2e-6) << "x = " << x;
  }
}

TEST(SplatKernel, HatsAreAPartitionOfUnityAndReproduceLinearFunctions) {
  expect_reproduces_linear_functions<poisson::HatKernel>();
}

TEST(SplatKernel, QuadraticBSplinesAreAPartitionOfUnityAndReproduceLinearFunctions) {
  expect_reproduces_linear_functions<poisson::QuadraticKernel>();
}

TEST(SplatKernel, ReachesNoFurtherThanItsSupport) {
  EXPECT_EQ(poisson::HatKernel{}(1.0F), 0.0F);
  EXPECT_EQ(poisson::HatKernel{}(-1.5F), 0.0F);
  EXPECT_EQ(poisson::QuadraticKernel{}(1.5F), 0.0F);
  EXPECT_EQ(poisson::QuadraticKernel{}(-2.0F), 0.0F);
  EXPECT_FLOAT_EQ(poisson::QuadraticKernel{}(0), 0.75F);
  EXPECT_FLOAT_EQ(poisson::QuadraticKernel{}(1), 0.125F);
}

}  // namespace
}  // namespace pointskin
