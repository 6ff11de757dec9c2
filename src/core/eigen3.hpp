// Eigenvectors of a symmetric 3 x 3 matrix: the same bits on every device.
// Source: Golub & Van Loan, "Matrix computations", 4th ed., section 8.5 (cyclic Jacobi). Differs: a fixed number of
// sweeps, so that no rounding decides how long it takes.
#pragma once

#include <cmath>

#include "core/matrix3.hpp"

namespace pointskin {

/// Eigenvalues, ascending, and their unit eigenvectors.
struct Eigen3 {
  double values[3];
  Vec3d vectors[3];
};

namespace eigen3 {

inline constexpr int kSweeps = 5;  // quadratic convergence: after 4 the rest is below a double's rounding

/// Rotates the plane of p and q so that a[p][q] becomes 0.
PSK_HD inline void rotate(double (&a)[3][3], double (&v)[3][3], int p, int q) {
  const double off = a[p][q];
  if (off == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * off);
  const double size = theta < 0 ? -theta : theta;
  const double root = size > 1e100 ? size : std::sqrt(theta * theta + 1);
  const double t = (theta < 0 ? -1.0 : 1.0) / (size + root);
  const double c = 1 / std::sqrt(t * t + 1);
  const double s = t * c;
  const int r = 3 - p - q;
  a[p][p] -= t * off;
  a[q][q] += t * off;
  a[p][q] = a[q][p] = 0;
  const double rp = a[r][p];
  const double rq = a[r][q];
  a[r][p] = a[p][r] = c * rp - s * rq;
  a[r][q] = a[q][r] = s * rp + c * rq;
  for (int k = 0; k < 3; ++k) {
    const double kp = v[k][p];
    const double kq = v[k][q];
    v[k][p] = c * kp - s * kq;
    v[k][q] = s * kp + c * kq;
  }
}

/// The next sweep would change no value beyond a double's rounding, and the vectors by 1e-15 where values are apart.
PSK_HD inline bool is_diagonal(const double (&a)[3][3]) {
  constexpr double kNone = 1e-30;
  const double off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
  return off <= kNone * (a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2]);
}

}  // namespace eigen3

PSK_HD inline Eigen3 eigen_of(const Symmetric3& m) {
  double a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < eigen3::kSweeps && !eigen3::is_diagonal(a); ++sweep) {
    eigen3::rotate(a, v, 0, 1);
    eigen3::rotate(a, v, 0, 2);
    eigen3::rotate(a, v, 1, 2);
  }
  int order[3] = {0, 1, 2};
  const auto sort_two = [&](int i, int j) {
    if (a[order[j]][order[j]] >= a[order[i]][order[i]]) return;
    const int other = order[i];
    order[i] = order[j];
    order[j] = other;
  };
  sort_two(0, 1);
  sort_two(1, 2);
  sort_two(0, 1);
  Eigen3 out;
  for (int i = 0; i < 3; ++i) {
    const int k = order[i];
    out.values[i] = a[k][k];
    out.vectors[i] = {v[0][k], v[1][k], v[2][k]};
  }
  return out;
}

}  // namespace pointskin
