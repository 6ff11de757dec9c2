#include "fluid/anisotropic.hpp"

#include "core/eigen3.hpp"
#include "core/vec3.hpp"
#include "exec/this_space.hpp"
#include "fluid/particle_tree.hpp"

namespace pointskin::fluid {
namespace {

using Covariance = pointskin::Symmetric3;

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
    Vec3d mean;
    Covariance products;
    int others = 0;
  };

  PSK_HD void operator()(std::int64_t i) const {
    const Sums sums = sum_up(i);
    const double inverse = 1 / sums.weight;
    const Vec3d mean = sums.mean * inverse;
    centres[i] = to_float(to_double(positions[i]) + mean * (kTowardsMean * radius));
    const Covariance covariance = sums.products * inverse + outer(mean) * -1.0;
    ellipsoids[i] = sums.others <= kFewNeighbours ? ball() : stretched(covariance);
  }

  [[nodiscard]] PSK_HD Sums sum_up(std::int64_t i) const {
    const Vec3d p = to_double(positions[i]);
    const double inverse = 1 / static_cast<double>(radius);
    Sums sums;
    for_each_neighbour(tree, tree.cell[i], [&](std::int32_t j) {
      const Vec3d d = (to_double(positions[j]) - p) * inverse;
      const double squared = dot(d, d);
      if (!(squared < 1)) return;
      const double w = 1 - squared * std::sqrt(squared);
      sums.weight += w;
      sums.others += j != i ? 1 : 0;
      sums.mean = sums.mean + d * w;
      sums.products = sums.products + outer(d) * w;
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

  [[nodiscard]] PSK_HD Ellipsoid stretched(const Covariance& covariance) const {
    const Eigen3 e = eigen_of(covariance);
    const double largest = e.values[2];
    if (!(largest > 0)) return ball();  // all at one place
    Covariance g;
    double product = 1;
    for (int k = 0; k < 3; ++k) {
      const double limited = e.values[k] > largest / kLargestStretch ? e.values[k] : largest / kLargestStretch;
      const double scaled = limited / kBulkEigenvalue;
      const double half_axis = scaled < kLeast ? kLeast : scaled < 1 ? scaled : 1.0;
      product *= half_axis;
      g = g + outer(e.vectors[k]) * (1 / half_axis);
    }
    const auto f = [](double value) { return static_cast<float>(value); };
    return {f(g.xx), f(g.xy), f(g.xz), f(g.yy), f(g.yz), f(g.zz), weight_of(product)};
  }
  /// Half axes are never shorter: particles crowded at one place are no needles of infinite density.
  static constexpr double kLeast = 0.125;
};

}  // namespace

template <exec::Space Exec>
Ellipsoids find_ellipsoids(Exec& ex, const ParticleTree& tree, ArrayView<const Vec3f> positions, float radius,
                           double volume_at_rest) {
  const std::int64_t n = positions.size;
  auto centres = exec::make_buffer<Vec3f>(ex, n);
  auto ellipsoids = exec::make_buffer<Ellipsoid>(ex, n);
  for_each(ex, "fluid.ellipsoids", n,
           FindEllipsoid{tree.view(), positions, radius, volume_at_rest, centres.view(), ellipsoids.view()});
  Ellipsoids sorted;
  sorted.tree = build_particle_tree(ex, centres.cview(), tree.grid);
  sorted.centres = exec::make_buffer<Vec3f>(ex, n);
  sorted.ellipsoids = exec::make_buffer<Ellipsoid>(ex, n);
  exec::gather(ex, centres.cview(), sorted.tree.order.cview(), sorted.centres.view());
  exec::gather(ex, ellipsoids.cview(), sorted.tree.order.cview(), sorted.ellipsoids.view());
  return sorted;
}

PSK_INSTANTIATE(find_ellipsoids);

}  // namespace pointskin::fluid
