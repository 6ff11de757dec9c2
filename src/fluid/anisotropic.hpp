// The density of particles that are ellipsoids, stretched along what is around them.
//
//   f(x) = sum_j V 315 / (64 pi) det(G_j) max(0, 1 - |G_j (x - c_j)|^2)^3,   V = (2 r)^3 the rest volume
//
// Source: Yu & Turk, "Reconstructing surfaces of particle-based fluids using anisotropic kernels", ACM TOG 32, 2013:
// centres c_j (6), covariances (9) to (11), their eigenvalues limited and scaled (15), G_j (16); k_r = 4, k_n = 0.5,
// lambda = 0.9. Differs: the kernel's polynomial; the eigenvalue of the bulk is known for the weights 1 - s^3 (0.15
// R^2), so k_s is no free constant; no ellipsoid reaches farther than the kernel's radius R; particles with
// kFewNeighbours or fewer are balls (25 in the paper, whose kernels hold about eight times as many particles).
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/float8.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "fluid/particle_tree.hpp"

namespace pointskin::fluid {

inline constexpr int kFewNeighbours = 6;         ///< within R, the particle itself not counted
inline constexpr double kLargestStretch = 4;     ///< k_r
inline constexpr double kBallOfFew = 0.5;        ///< k_n, in R
inline constexpr double kTowardsMean = 0.9;      ///< lambda
inline constexpr double kBulkEigenvalue = 0.15;  ///< of the covariance, in R^2

/// G in units of 1 / R, symmetric, and what the kernel's power is multiplied with.
struct Ellipsoid {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  float weight = 0;
};

/// The field as kernels see it, over centres in the unit cube.
struct AnisotropicField {
  ParticleTreeView tree;             ///< of the centres
  ArrayView<const Vec3f> positions;  ///< the centres, in the order of the tree's keys
  ArrayView<const Ellipsoid> ellipsoids;
  float radius = 0;     ///< R, unit cube
  float threshold = 0;  ///< share of the density at rest
  float cells = 0;      ///< finest cells in which the density falls by about that at rest

  [[nodiscard]] PSK_HD float reach() const { return radius; }

  template <class T>
  PSK_HD PSK_INLINE static T density(const Ellipsoid& e, const T& dx, const T& dy, const T& dz) {
    const T zero{};
    const T gx = e.xx * dx + e.xy * dy + e.xz * dz;
    const T gy = e.xy * dx + e.yy * dy + e.yz * dz;
    const T gz = e.xz * dx + e.yz * dy + e.zz * dz;
    const T difference = 1.0F - (gx * gx + gy * gy + gz * gz);
    const T q = difference > zero ? difference : zero;
    return e.weight * (q * q * q);
  }

  [[nodiscard]] PSK_HD float at(const Vec3f& x) const {
    const float inverse = 1 / radius;
    float sum = 0;
    for_each_range_near(tree, x, x, radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f p = positions[j];
        const float dx = (p.x - x.x) * inverse;
        const float dy = (p.y - x.y) * inverse;
        const float dz = (p.z - x.z) * inverse;
        if (dx * dx + dy * dy + dz * dz < 1.01F) sum += density(ellipsoids[j], dx, dy, dz);
      }
    });
    return (sum - threshold) * cells;
  }

#if PSK_WIDE
  /// The values at the 8 corners of a brick, as ZhuBridsonField::at_brick.
  PSK_INLINE void at_brick(const Vec3f& lower, float width, float* out) const {
    const Float8 x = lower.x + Float8{0, 0, 0, 0, 1, 1, 1, 1} * width;
    const Float8 y = lower.y + Float8{0, 0, 1, 1, 0, 0, 1, 1} * width;
    const Float8 z = lower.z + Float8{0, 1, 0, 1, 0, 1, 0, 1} * width;
    const float inverse = 1 / radius;
    const float half = 0.5F * width;
    const Vec3f centre{lower.x + half, lower.y + half, lower.z + half};
    const float far = (radius + 0.8661F * width) * 1.0001F;
    Float8 sum{};
    for_each_range_near(tree, lower, {lower.x + width, lower.y + width, lower.z + width}, radius,
                        [&](std::int32_t first, std::int32_t last) {
                          for (std::int32_t j = first; j < last; ++j) {
                            const Vec3f p = positions.data[j];
                            const float cx = p.x - centre.x;
                            const float cy = p.y - centre.y;
                            const float cz = p.z - centre.z;
                            if (cx * cx + cy * cy + cz * cz > far * far) continue;
                            sum += density<Float8>(ellipsoids.data[j], (p.x - x) * inverse, (p.y - y) * inverse,
                                                   (p.z - z) * inverse);
                          }
                        });
    const Float8 values = (sum - threshold) * cells;
    store8(values, out);
  }
#endif
};

/// Ellipsoids with their centres, sorted for searches; in the space that they were made in.
struct Ellipsoids {
  ParticleTree tree;                   ///< of the centres
  exec::Buffer<Vec3f> centres;         ///< (n) in the order of the tree's keys, unit cube
  exec::Buffer<Ellipsoid> ellipsoids;  ///< (n)
};

/// @param tree            of `positions`, in the order of its keys, over the unit cube; its cells are as wide as
/// `radius`
/// @param volume_at_rest  of a particle, in R^3
/// O(n), two passes over the neighbours; one more tree. Deterministic: gathers in a fixed order, in double.
template <exec::Space Exec>
Ellipsoids find_ellipsoids(Exec& ex, const ParticleTree& tree, ArrayView<const Vec3f> positions, float radius,
                           double volume_at_rest);

}  // namespace pointskin::fluid
