// Finite-element stencils of hat functions on a grid of corners, derived from their one-dimensional factors.
//
// Per cell of side h and axis, with end corners 0 and 1 (docs/algorithm.md, equations 4-6):
//   mass        M = h / 6 [ 2  1;  1  2]
//   stiffness   K = 1 / h [ 1 -1; -1  1]
//   derivative  D[i][j] = integral phi_j phi_i' = 1 / 2 [-1 -1; 1 1]
//   spread      S = h / 6 [ 1  2;  2  1]: the mass matrix with the ends of its columns exchanged. Summed, its row takes
//               the mean of a corner and its two neighbours (docs/decisions/0017-noise-and-smoothness.md)
// Summed over the cells around a corner, tensor products of these give operators on the 27 corners around it.
// Everything is in units of h: the Laplacian is divided by h, the divergence by h^2. Source: Zhou et al. 2010,
// section 4.1 (the same products for hats at cell centres).
#pragma once

#include <array>

#include "core/host_device.hpp"

namespace pointskin::poisson {

/// Which cells of an axis lie around a corner: at the cube's faces one of the two is missing (natural boundary).
enum class AxisSide : int { inside = 0, lower_face = 1, upper_face = 2 };

/// Coefficients for the neighbours at -1, 0, +1.
using Row = std::array<double, 3>;

/// One-dimensional rows, one per AxisSide.
struct AxisRows {
  std::array<Row, 3> mass, stiffness, derivative, spread;
};

/// Assembles the rows of a corner from the element matrices of the cells that exist around it.
constexpr AxisRows make_axis_rows() {
  constexpr double kMass[2][2] = {{2 / 6.0, 1 / 6.0}, {1 / 6.0, 2 / 6.0}};
  constexpr double kSpread[2][2] = {{1 / 6.0, 2 / 6.0}, {2 / 6.0, 1 / 6.0}};
  constexpr double kStiffness[2][2] = {{1, -1}, {-1, 1}};
  constexpr double kDerivative[2][2] = {{-0.5, -0.5}, {0.5, 0.5}};
  AxisRows rows{};
  for (std::size_t side = 0; side < 3; ++side) {
    const bool has_lower = side != static_cast<std::size_t>(AxisSide::lower_face);
    const bool has_upper = side != static_cast<std::size_t>(AxisSide::upper_face);
    for (std::size_t other = 0; other < 2; ++other) {
      if (has_lower) {  // the corner is end 1 of its lower cell, whose ends are at -1 and 0
        rows.mass[side][other] += kMass[1][other];
        rows.stiffness[side][other] += kStiffness[1][other];
        rows.derivative[side][other] += kDerivative[1][other];
        rows.spread[side][other] += kSpread[1][other];
      }
      if (has_upper) {  // and end 0 of its upper cell, whose ends are at 0 and +1
        rows.mass[side][other + 1] += kMass[0][other];
        rows.stiffness[side][other + 1] += kStiffness[0][other];
        rows.derivative[side][other + 1] += kDerivative[0][other];
        rows.spread[side][other + 1] += kSpread[0][other];
      }
    }
  }
  return rows;
}

inline constexpr AxisRows kAxisRows = make_axis_rows();

/// Laplacian coefficient for offset (a, b, c) - 1 of a corner with these sides: K M M + M K M + M M K.
constexpr double laplacian_coefficient(const std::array<std::size_t, 3>& sides, const std::array<std::size_t, 3>& at) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double product = 1;
    for (std::size_t other = 0; other < 3; ++other)
      product *= (other == axis ? kAxisRows.stiffness : kAxisRows.mass)[sides[other]][at[other]];
    sum += product;
  }
  return sum;
}

/// Divergence coefficient along `axis`: D S S and its permutations.
constexpr double divergence_coefficient(std::size_t axis, const std::array<std::size_t, 3>& at) {
  double product = 1;
  for (std::size_t other = 0; other < 3; ++other)
    product *= (other == axis ? kAxisRows.derivative : kAxisRows.spread)[0][at[other]];
  return product;
}

/// The Laplacian away from the cube's faces has four distinct coefficients; the six face neighbours have none.
struct InsideLaplacian {
  static constexpr double kCentre = laplacian_coefficient({0, 0, 0}, {1, 1, 1});
  static constexpr double kFace = laplacian_coefficient({0, 0, 0}, {0, 1, 1});
  static constexpr double kEdge = laplacian_coefficient({0, 0, 0}, {0, 0, 1});
  static constexpr double kCorner = laplacian_coefficient({0, 0, 0}, {0, 0, 0});
};
constexpr bool nearly(double a, double b) { return (a > b ? a - b : b - a) < 1e-14; }
static_assert(nearly(InsideLaplacian::kFace, 0));
static_assert(nearly(InsideLaplacian::kCentre + 12 * InsideLaplacian::kEdge + 8 * InsideLaplacian::kCorner, 0));

/// Largest eigenvalue of the Laplacian in units of h: its symbol's maximum, at (pi, 0, 0).
inline constexpr float kLargestEigenvalue = 4;

/// Rows as floats, to travel into kernels.
struct AxisRowsF {
  float mass[3][3], stiffness[3][3];
};
constexpr AxisRowsF make_axis_rows_f() {
  AxisRowsF rows{};
  for (std::size_t side = 0; side < 3; ++side)
    for (std::size_t i = 0; i < 3; ++i) {
      rows.mass[side][i] = static_cast<float>(kAxisRows.mass[side][i]);
      rows.stiffness[side][i] = static_cast<float>(kAxisRows.stiffness[side][i]);
    }
  return rows;
}

}  // namespace pointskin::poisson
