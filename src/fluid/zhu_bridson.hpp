// The distance field of particles: how far a place is from the weighted mean of the particles around it.
//
//   m(x) = sum_j k_j p_j / sum_j k_j,   k_j = max(0, 1 - |x - p_j|^2 / R^2)^3
//   phi(x) = |x - m(x)| - f t,   t the threshold, f = 1 - (1 - g)^3,   g = clamp((high - lambda) / (high - low), 0, 1)
//
// Source: Zhu & Bridson, "Animating sand as a fluid", SIGGRAPH 2005, section 5. Where m runs ahead of x, between drops
// and in concave places, phi has spurious blobs; they are damped by f as in Solenthaler, Schlaefli & Pajarola, "A
// unified particle model for fluid-solid interactions", 2007, section 4.3, lambda the largest eigenvalue of the
// gradient of m. Differs: lambda is sum e^9 / sum e^8 over the eigenvalues e of the symmetric part, which two traces
// give without finding any; low is 1.2 instead of 0.4, because lambda is 1 along every flat surface and inside, where f
// should be 1; places farther than kReach R from every particle are outside (f is 0 there anyway).
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/float8.hpp"
#include "core/host_device.hpp"
#include "fluid/particle_tree.hpp"

namespace pointskin::fluid {

/// Share of the kernel radius beyond which nothing is inside. With all particles so far away lambda is
/// 2 a (a - d) / (1 - a^2) at least, a = kReach, d = |x - m| / R: above kHighEigenvalue for all d that f t allows.
inline constexpr float kReach = 0.75F;
inline constexpr float kLowEigenvalue = 1.2F;
inline constexpr float kHighEigenvalue = 2.0F;

/// What is summed over the particles around a place; d = (p - x) / R, q = max(0, 1 - |d|^2). T: a float or several.
template <class T>
struct MeanSums {
  T weight{};                            ///< q^3
  T x{}, y{}, z{};                       ///< q^3 d
  T sx{}, sy{}, sz{};                    ///< q^2 d
  T xx{}, xy{}, xz{}, yy{}, yz{}, zz{};  ///< q^2 d d^T
  T nearest{};                           ///< largest q

  PSK_HD PSK_INLINE void add(const T& dx, const T& dy, const T& dz) {
    const T zero{};
    const T difference = 1.0F - (dx * dx + dy * dy + dz * dz);
    const T q = difference > zero ? difference : zero;
    const T slope = q * q;
    const T k = slope * q;
    nearest = q > nearest ? q : nearest;
    weight += k;
    x += k * dx;
    y += k * dy;
    z += k * dz;
    const T ax = slope * dx;
    const T ay = slope * dy;
    const T az = slope * dz;
    sx += ax;
    sy += ay;
    sz += az;
    xx += ax * dx;
    xy += ax * dy;
    xz += ax * dz;
    yy += ay * dy;
    yz += ay * dz;
    zz += az * dz;
  }
};

/// A symmetric 3 x 3 matrix.
struct Symmetric3 {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  /// Sum of the products of all entries: the trace of this times other.
  [[nodiscard]] PSK_HD float dot(const Symmetric3& o) const {
    return xx * o.xx + yy * o.yy + zz * o.zz + 2 * (xy * o.xy + xz * o.xz + yz * o.yz);
  }
  [[nodiscard]] PSK_HD Symmetric3 squared() const {
    return {xx * xx + xy * xy + xz * xz, xx * xy + xy * yy + xz * yz, xx * xz + xy * yz + xz * zz,
            xy * xy + yy * yy + yz * yz, xy * xz + yy * yz + yz * zz, xz * xz + yz * yz + zz * zz};
  }
  [[nodiscard]] PSK_HD Symmetric3 scaled(float s) const { return {s * xx, s * xy, s * xz, s * yy, s * yz, s * zz}; }
};

/// The mean of the eigenvalues with their eighth powers as weights: the largest in magnitude if others are much
/// smaller, never above, and 3 % below at the most where it is positive and none is negative.
PSK_HD inline float largest_eigenvalue(const Symmetric3& m) {
  const float norm = std::sqrt(m.dot(m));
  if (!(norm > 0)) return 0;
  const Symmetric3 unit = m.scaled(1 / norm);
  const Symmetric3 eighth = unit.squared().squared().squared();
  return norm * (eighth.dot(unit) / (eighth.xx + eighth.yy + eighth.zz));
}

/// The field as kernels see it, over particles in the unit cube.
struct ZhuBridsonField {
  ParticleTreeView tree;
  ArrayView<const Vec3f> positions;  ///< in the order of the tree's keys
  float radius = 0;                  ///< R, unit cube
  float threshold = 0;               ///< t / R
  float cells = 0;                   ///< finest cells in R: values are in finest cells, positive inside

  /// Distance from particles, unit cube, beyond which nothing is inside.
  [[nodiscard]] PSK_HD float reach() const { return kReach * radius; }

  [[nodiscard]] PSK_HD float at(const Vec3f& x) const {
    MeanSums<float> sums;
    const float inverse = 1 / radius;
    for_each_range_near(tree, x, x, radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f p = positions[j];
        sums.add((p.x - x.x) * inverse, (p.y - x.y) * inverse, (p.z - x.z) * inverse);
      }
    });
    return value_of(sums);
  }

  [[nodiscard]] PSK_HD float value_of(const MeanSums<float>& sums) const {
    const float outside = (threshold - kReach) * cells;
    if (!(sums.nearest > 1 - kReach * kReach)) return outside;
    const float inverse = 1 / sums.weight;
    const float x = sums.x * inverse;
    const float y = sums.y * inverse;
    const float z = sums.z * inverse;
    const float distance = std::sqrt(x * x + y * y + z * z);
    const float six = 6 * inverse;
    const Symmetric3 gradient{six * (sums.xx - x * sums.sx),
                              six * (sums.xy - 0.5F * (x * sums.sy + y * sums.sx)),
                              six * (sums.xz - 0.5F * (x * sums.sz + z * sums.sx)),
                              six * (sums.yy - y * sums.sy),
                              six * (sums.yz - 0.5F * (y * sums.sz + z * sums.sy)),
                              six * (sums.zz - z * sums.sz)};
    return (threshold * damping(largest_eigenvalue(gradient)) - distance) * cells;
  }

  PSK_HD static float damping(float eigenvalue) {
    const float g = (kHighEigenvalue - eigenvalue) * (1 / (kHighEigenvalue - kLowEigenvalue));
    const float rest = g >= 1 ? 0.0F : g > 0 ? 1 - g : 1.0F;
    return 1 - rest * rest * rest;
  }

#if PSK_WIDE
  /// The values at the 8 corners of a brick whose first corner is `lower` and whose corners are `width` apart: what
  /// at() returns for each, bit for bit.
  PSK_INLINE void at_brick(const Vec3f& lower, float width, float* out) const {
    const Float8 x = lower.x + Float8{0, 0, 0, 0, 1, 1, 1, 1} * width;
    const Float8 y = lower.y + Float8{0, 0, 1, 1, 0, 0, 1, 1} * width;
    const Float8 z = lower.z + Float8{0, 1, 0, 1, 0, 1, 0, 1} * width;
    const float inverse = 1 / radius;
    const float half = 0.5F * width;
    const Vec3f centre{lower.x + half, lower.y + half, lower.z + half};
    // Particles that no corner can see add zeros; they are left out.
    const float far = (radius + 0.8661F * width) * 1.0001F;
    MeanSums<Float8> sums;
    const Vec3f upper{lower.x + width, lower.y + width, lower.z + width};
    for_each_range_near(tree, lower, upper, radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f p = positions.data[j];
        const float cx = p.x - centre.x;
        const float cy = p.y - centre.y;
        const float cz = p.z - centre.z;
        if (cx * cx + cy * cy + cz * cz > far * far) continue;
        sums.add((p.x - x) * inverse, (p.y - y) * inverse, (p.z - z) * inverse);
      }
    });
    for (int s = 0; s < 8; ++s)
      out[s] = value_of({sums.weight[s], sums.x[s], sums.y[s], sums.z[s], sums.sx[s], sums.sy[s], sums.sz[s],
                         sums.xx[s], sums.xy[s], sums.xz[s], sums.yy[s], sums.yz[s], sums.zz[s], sums.nearest[s]});
  }
#endif
};

}  // namespace pointskin::fluid
