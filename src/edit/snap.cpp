#include "edit/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pointskin::edit {
namespace snap {
namespace {

/// Rotation by the length of `turn`, in radians, about its direction (Rodrigues).
std::array<double, 9> rotation_by(const Vec3d& turn) {
  const double angle = std::sqrt(squared_length(turn));
  const double s = angle > 0 ? std::sin(angle) / angle : 1;
  const double half = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  const double c = 2 * half * half;  // (1 - cos(angle)) / angle^2
  const double x = turn[0];
  const double y = turn[1];
  const double z = turn[2];
  return {1 - c * (y * y + z * z), c * x * y - s * z,       c * x * z + s * y,
          c * x * y + s * z,       1 - c * (x * x + z * z), c * y * z - s * x,
          c * x * z - s * y,       c * y * z + s * x,       1 - c * (x * x + y * y)};
}

/// Replaces m by r m.
void multiply(const std::array<double, 9>& r, double* m) {
  std::array<double, 9> product{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      product[3 * i + j] = r[3 * i] * m[j] + r[3 * i + 1] * m[3 + j] + r[3 * i + 2] * m[6 + j];
  std::copy(product.begin(), product.end(), m);
}

/// Solves a symmetric positive definite system by Cholesky's method.
bool solve(std::array<std::array<double, 6>, 6>& a, std::array<double, 6>& x) {
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    if (!(a[j][j] > 0)) return false;
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < 6; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (std::size_t i = 6; i-- > 0;) {
    for (std::size_t k = i + 1; k < 6; ++k) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return true;
}

}  // namespace

bool step(const Equations& equations, const Vec3d& centre, double radius, Placement& motion, double& change) {
  // Turns count as the way they take at the radius, so that all six unknowns are lengths; what the planes leave open
  // (a part that may slide) stays as it is.
  constexpr double kHold = 1e-9;
  const std::array<double, 6> unit = {radius, radius, radius, 1, 1, 1};
  std::array<std::array<double, 6>, 6> a{};
  std::array<double, 6> x{};
  int at = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = i; j < 6; ++j) a[j][i] = a[i][j] = equations.matrix[at++] / (unit[i] * unit[j]);
    a[i][i] += kHold * equations.count;
    x[i] = equations.right[i] / unit[i];
  }
  if (!solve(a, x)) return false;
  const Vec3d turn{x[0] / radius, x[1] / radius, x[2] / radius};
  const std::array<double, 9> rotation = rotation_by(turn);
  multiply(rotation, motion.matrix);
  multiply(rotation, motion.turn);
  Vec3d shift{};
  for (std::size_t i = 0; i < 3; ++i) {  // about the centre, then along
    shift[i] = centre[i] + x[3 + i];
    for (std::size_t j = 0; j < 3; ++j) shift[i] += rotation[3 * i + j] * (motion.shift[j] - centre[j]);
  }
  for (std::size_t i = 0; i < 3; ++i) motion.shift[i] = shift[i];
  change = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) + std::sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
  return std::isfinite(change);
}

}  // namespace snap

}  // namespace pointskin::edit
