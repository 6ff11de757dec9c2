// One level's linear system, assembled cell by cell in double: what the matrix-free operator must equal.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "poisson/screening.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin::test {

/// integral grad phi_i . grad phi_j over the unit cell; corners by slot.
inline double element_stiffness(int i, int j) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double product = 1;
    for (int other = 0; other < 3; ++other) {
      const bool same = (i >> (2 - other) & 1) == (j >> (2 - other) & 1);
      product *= other == axis ? (same ? 1.0 : -1.0) : (same ? 2 / 6.0 : 1 / 6.0);
    }
    sum += product;
  }
  return sum;
}

/// Rows and columns of all nodes of a level; rows of corners that are no unknowns are incomplete sums over existing
/// cells.
struct ReferenceSystem {
  Eigen::SparseMatrix<double> matrix;  ///< Laplacian + screening, in units of h
  Eigen::VectorXd pull;                ///< screening's right-hand side
  std::vector<std::int64_t> unknowns;  ///< nodes, ascending
};

/// Trilinear weights of a collapsed sample.
inline double sample_weight(const poisson::CollapsedSample& s, int slot) {
  return (octree::slot_x(slot) != 0 ? s.x : 1.0 - s.x) * (octree::slot_y(slot) != 0 ? s.y : 1.0 - s.y) *
         (octree::slot_z(slot) != 0 ? s.z : 1.0 - s.z);
}

/// @param scale  w 4^(d - D); 0: no screening, `screening` is not read
inline ReferenceSystem assemble(const octree::LevelView& level, const poisson::ScreeningView& screening, double scale) {
  ReferenceSystem system;
  std::vector<Eigen::Triplet<double>> entries;
  system.pull = Eigen::VectorXd::Zero(level.nodes());
  for (std::int64_t cell = 0; cell < level.cells(); ++cell) {
    std::int32_t corner[8];
    for (int s = 0; s < 8; ++s) corner[s] = corner_of(level, cell, s);
    poisson::CollapsedSample sample;
    if (scale > 0 && screening.brick_index[cell >> 3] >= 0)
      sample = screening.samples[8 * std::int64_t{screening.brick_index[cell >> 3]} + (cell & 7)];
    const double weight = sample.weight > 0 ? scale * sample.weight : 0;
    for (int i = 0; i < 8; ++i) {
      system.pull[corner[i]] += 0.5 * weight * sample_weight(sample, i);
      for (int j = 0; j < 8; ++j)
        entries.emplace_back(corner[i], corner[j],
                             element_stiffness(i, j) + weight * sample_weight(sample, i) * sample_weight(sample, j));
    }
  }
  system.matrix.resize(level.nodes(), level.nodes());
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  for (std::int64_t n = 0; n < level.nodes(); ++n)
    if (is_unknown(level, n)) system.unknowns.push_back(n);
  return system;
}

/// By factors or, where these would fill up (a complete level of 32^3 cells takes half a minute), by conjugate gradients
/// until nothing is left but the rounding of double.
inline Eigen::VectorXd solution_of(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& right) {
  constexpr Eigen::Index kFactored = 20'000;
  if (matrix.rows() <= kFactored) return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> gradients(matrix);
  gradients.setTolerance(1e-13);
  return gradients.solve(right);
}

/// Solves the rows of the unknowns, the other corners keeping their values in `u`.
/// @returns u with the unknowns replaced
inline Eigen::VectorXd solve_directly(const ReferenceSystem& system, const Eigen::VectorXd& b, Eigen::VectorXd u) {
  const auto count = static_cast<Eigen::Index>(system.unknowns.size());
  std::vector<Eigen::Index> place(static_cast<std::size_t>(u.size()), -1);
  for (Eigen::Index i = 0; i < count; ++i) {
    place[static_cast<std::size_t>(system.unknowns[static_cast<std::size_t>(i)])] = i;
    u[system.unknowns[static_cast<std::size_t>(i)]] = 0;
  }
  const Eigen::VectorXd full = b + system.pull - system.matrix * u;
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) right[i] = full[system.unknowns[static_cast<std::size_t>(i)]];
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < system.matrix.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(system.matrix, column); it; ++it) {
      const Eigen::Index r = place[static_cast<std::size_t>(it.row())];
      const Eigen::Index c = place[static_cast<std::size_t>(it.col())];
      if (r >= 0 && c >= 0) entries.emplace_back(r, c, it.value());
    }
  Eigen::SparseMatrix<double> inner(count, count);
  inner.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd solution = solution_of(inner, right);
  for (Eigen::Index i = 0; i < count; ++i) u[system.unknowns[static_cast<std::size_t>(i)]] = solution[i];
  return u;
}

}  // namespace pointskin::test
