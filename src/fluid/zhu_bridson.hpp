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

/// Values below, in finest cells, are not damped: what is so far outside stays there.
inline constexpr float kFarOutside = -1.5F;

/// What is summed over the particles around a place; d = (p - x) / R, q = max(0, 1 - |d|^2). T: a float or several.
template <class T>
struct MeanSums {
  T weight{};       ///< q^3
  T x{}, y{}, z{};  ///< q^3 d
  T nearest{};      ///< largest q

  PSK_HD PSK_INLINE void add(const T& dx, const T& dy, const T& dz) {
    const T zero{};
    const T difference = 1.0F - (dx * dx + dy * dy + dz * dz);
    const T q = difference > zero ? difference : zero;
    const T k = q * q * q;
    nearest = q > nearest ? q : nearest;
    weight += k;
    x += k * dx;
    y += k * dy;
    z += k * dz;
  }
};

/// What its gradient needs besides.
template <class T>
struct GradientSums {
  T x{}, y{}, z{};                       ///< q^2 d
  T xx{}, xy{}, xz{}, yy{}, yz{}, zz{};  ///< q^2 d d^T

  PSK_HD PSK_INLINE void add(const T& dx, const T& dy, const T& dz) {
    const T zero{};
    const T difference = 1.0F - (dx * dx + dy * dy + dz * dz);
    const T q = difference > zero ? difference : zero;
    const T slope = q * q;
    const T ax = slope * dx;
    const T ay = slope * dy;
    const T az = slope * dz;
    x += ax;
    y += ay;
    z += az;
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
/// smaller, never above, and 6 % below at the most where none is negative.
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
    GradientSums<float> gradient;
    const float inverse = 1 / radius;
    for_each_range_near(tree, x, x, radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f p = positions[j];
        const float dx = (p.x - x.x) * inverse;
        const float dy = (p.y - x.y) * inverse;
        const float dz = (p.z - x.z) * inverse;
        sums.add(dx, dy, dz);
        gradient.add(dx, dy, dz);
      }
    });
    const Mean mean = mean_of(sums);
    return mean.is_final ? mean.value : damped(mean, gradient);
  }

  /// Without the gradient.
  struct Mean {
    float x, y, z, inverse_weight, distance;
    float value;    ///< undamped, finest cells
    bool is_final;  ///< nothing is left to be damped
  };
  [[nodiscard]] PSK_HD Mean mean_of(const MeanSums<float>& sums) const {
    if (!(sums.nearest > 1 - kReach * kReach)) return {0, 0, 0, 0, 0, (threshold - kReach) * cells, true};
    const float inverse = 1 / sums.weight;
    const float x = sums.x * inverse;
    const float y = sums.y * inverse;
    const float z = sums.z * inverse;
    const float distance = std::sqrt(x * x + y * y + z * z);
    const float value = (threshold - distance) * cells;
    return {x, y, z, inverse, distance, value, value < kFarOutside};
  }

  [[nodiscard]] PSK_HD float damped(const Mean& m, const GradientSums<float>& sums) const {
    const float six = 6 * m.inverse_weight;
    const Symmetric3 gradient{six * (sums.xx - m.x * sums.x),
                              six * (sums.xy - 0.5F * (m.x * sums.y + m.y * sums.x)),
                              six * (sums.xz - 0.5F * (m.x * sums.z + m.z * sums.x)),
                              six * (sums.yy - m.y * sums.y),
                              six * (sums.yz - 0.5F * (m.y * sums.z + m.z * sums.y)),
                              six * (sums.zz - m.z * sums.z)};
    return (threshold * damping(largest_eigenvalue(gradient)) - m.distance) * cells;
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
    MeanSums<Float8> sums;
    ParticlesAround around(*this, lower, width);
    around.for_each([&](const Vec3f& p) { sums.add((p.x - x) * inverse, (p.y - y) * inverse, (p.z - z) * inverse); });
    Mean means[8];
    bool all_final = true;
    for (int s = 0; s < 8; ++s) {
      means[s] = mean_of({sums.weight[s], sums.x[s], sums.y[s], sums.z[s], sums.nearest[s]});
      out[s] = means[s].value;
      all_final = all_final && means[s].is_final;
    }
    if (all_final) return;
    GradientSums<Float8> g;
    around.for_each([&](const Vec3f& p) { g.add((p.x - x) * inverse, (p.y - y) * inverse, (p.z - z) * inverse); });
    for (int s = 0; s < 8; ++s)
      if (!means[s].is_final)
        out[s] = damped(means[s], {g.x[s], g.y[s], g.z[s], g.xx[s], g.xy[s], g.xz[s], g.yy[s], g.yz[s], g.zz[s]});
  }

 private:
  /// The particles that some corner of a brick sees. Others add zeros; they are left out without a branch.
  class ParticlesAround {
   public:
    PSK_INLINE ParticlesAround(const ZhuBridsonField& field, const Vec3f& lower, float width)
        : field_(field), lower_(lower), width_(width) {
      const float half = 0.5F * width;
      const Vec3f centre{lower.x + half, lower.y + half, lower.z + half};
      const float far = (field.radius + 0.8661F * width) * 1.0001F;
      visit_ranges([&](std::int32_t first, std::int32_t last) {
        for (std::int32_t j = first; j < last; ++j) {
          const Vec3f p = field.positions.data[j];
          const float dx = p.x - centre.x;
          const float dy = p.y - centre.y;
          const float dz = p.z - centre.z;
          near_[count_ < kRoom ? count_ : kRoom] = p;
          count_ += dx * dx + dy * dy + dz * dz <= far * far ? 1 : 0;
        }
      });
    }
    template <class Visit>
    PSK_INLINE void for_each(const Visit& visit) const {
      if (count_ <= kRoom) {
        for (int i = 0; i < count_; ++i) visit(near_[i]);
      } else {
        visit_ranges([&](std::int32_t first, std::int32_t last) {
          for (std::int32_t j = first; j < last; ++j) visit(field_.positions.data[j]);
        });
      }
    }

   private:
    template <class Visit>
    PSK_INLINE void visit_ranges(const Visit& visit) const {
      for_each_range_near(field_.tree, lower_, {lower_.x + width_, lower_.y + width_, lower_.z + width_}, field_.radius,
                          visit);
    }
    static constexpr int kRoom = 512;
    const ZhuBridsonField& field_;
    Vec3f lower_;
    float width_;
    int count_ = 0;
    Vec3f near_[kRoom + 1];  // the last one is for what does not count
  };
#endif
};

}  // namespace pointskin::fluid
