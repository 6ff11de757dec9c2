#pragma once

#include "exec/algorithms.hpp"
#include "fluid/anisotropic.hpp"
#include "fluid/particle_tree_impl.hpp"

namespace pointskin::fluid {
namespace anisotropic {

struct FindEllipsoid {
  ParticleTreeView tree;
  ArrayView<const Vec3f> positions;
  float radius;
  double volume;  // at rest, in R^3
  ArrayView<Vec3f> centres;
  ArrayView<Ellipsoid> ellipsoids;

  /// Weighted sums over the neighbours, relative to the particle, in R.
  struct Sums {
    double weight = 0;
    double mean[3] = {0, 0, 0};
    double products[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    int others = 0;
  };

  PSK_HD void operator()(std::int64_t i) const {
    const Sums sums = sum_up(i);
    const double inverse = 1 / sums.weight;
    double covariance[3][3];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        covariance[a][b] = inverse * sums.products[a][b] - inverse * inverse * sums.mean[a] * sums.mean[b];
    const Vec3f p = positions[i];
    const double step = kTowardsMean * inverse * radius;
    centres[i] = {static_cast<float>(p.x + step * sums.mean[0]), static_cast<float>(p.y + step * sums.mean[1]),
                  static_cast<float>(p.z + step * sums.mean[2])};
    ellipsoids[i] = sums.others <= kFewNeighbours ? ball() : stretched(covariance);
  }

  [[nodiscard]] PSK_HD Sums sum_up(std::int64_t i) const {
    const Vec3f p = positions[i];
    const double inverse = 1 / static_cast<double>(radius);
    Sums sums;
    for_each_neighbour(tree, tree.cell[i], [&](std::int32_t j) {
      const Vec3f n = positions[j];
      const double d[3] = {(static_cast<double>(n.x) - p.x) * inverse, (static_cast<double>(n.y) - p.y) * inverse,
                           (static_cast<double>(n.z) - p.z) * inverse};
      const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      if (!(squared < 1)) return;
      const double w = 1 - squared * std::sqrt(squared);
      sums.weight += w;
      sums.others += j != i ? 1 : 0;
      for (int a = 0; a < 3; ++a) {
        sums.mean[a] += w * d[a];
        for (int b = 0; b < 3; ++b) sums.products[a][b] += w * d[a] * d[b];
      }
    });
    return sums;
  }

  /// What the polynomial is multiplied with, for half axes with this product, in R.
  [[nodiscard]] PSK_HD float weight_of(double half_axes) const {
    constexpr double kNorm = 1.5666814710608448;  // 315 / (64 pi)
    return static_cast<float>(kNorm * volume / half_axes);
  }

  [[nodiscard]] PSK_HD Ellipsoid ball() const {
    constexpr auto kInverse = static_cast<float>(1 / kBallOfFew);
    return {kInverse, 0, 0, kInverse, 0, kInverse, weight_of(kBallOfFew * kBallOfFew * kBallOfFew)};
  }

  [[nodiscard]] PSK_HD Ellipsoid stretched(double (&covariance)[3][3]) const {
    const Eigen3 e = eigen_of(covariance);
    double largest = e.values[0] > e.values[1] ? e.values[0] : e.values[1];
    largest = e.values[2] > largest ? e.values[2] : largest;
    if (!(largest > 0)) return ball();  // all at one place
    double g[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    double product = 1;
    for (int k = 0; k < 3; ++k) {
      const double limited = e.values[k] > largest / kLargestStretch ? e.values[k] : largest / kLargestStretch;
      const double scaled = limited / kBulkEigenvalue;
      const double half_axis = scaled < kLeast ? kLeast : scaled < 1 ? scaled : 1.0;
      product *= half_axis;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) g[a][b] += e.vectors[a][k] * e.vectors[b][k] / half_axis;
    }
    const auto f = [&](int a, int b) { return static_cast<float>(g[a][b]); };
    return {f(0, 0), f(0, 1), f(0, 2), f(1, 1), f(1, 2), f(2, 2), weight_of(product)};
  }
  /// Half axes are never shorter: particles crowded at one place are no needles of infinite density.
  static constexpr double kLeast = 0.125;
};

}  // namespace anisotropic

template <exec::Space Exec>
Ellipsoids find_ellipsoids(Exec& ex, const ParticleTree& tree, ArrayView<const Vec3f> positions, float radius,
                           double volume_at_rest) {
  const std::int64_t n = positions.size;
  auto centres = exec::make_buffer<Vec3f>(ex, n);
  auto ellipsoids = exec::make_buffer<Ellipsoid>(ex, n);
  for_each(
      ex, "fluid.ellipsoids", n,
      anisotropic::FindEllipsoid{tree.view(), positions, radius, volume_at_rest, centres.view(), ellipsoids.view()});
  Ellipsoids sorted;
  sorted.tree = build_particle_tree(ex, centres.cview(), tree.grid);
  sorted.centres = exec::make_buffer<Vec3f>(ex, n);
  sorted.ellipsoids = exec::make_buffer<Ellipsoid>(ex, n);
  exec::gather(ex, centres.cview(), sorted.tree.order.cview(), sorted.centres.view());
  exec::gather(ex, ellipsoids.cview(), sorted.tree.order.cview(), sorted.ellipsoids.view());
  return sorted;
}

}  // namespace pointskin::fluid
