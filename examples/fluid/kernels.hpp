// Smoothing kernels, and the part of a kernel that walls cover. Lengths are in kernel radii.
// Sources: Mueller, Charypar & Gross, "Particle-based fluid simulation for interactive applications", 2003 (poly6 for
// the density, spiky for its gradient). Differs: solids are no particles. Walls mirror the fluid; what the
// obstacle covers of a kernel is a polynomial of the distance, scaled so that a lattice that rests against it has
// exactly the rest density.
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/host_device.hpp"

namespace pointskin::simulation {

PSK_HD inline Vec3f operator+(const Vec3f& a, const Vec3f& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PSK_HD inline Vec3f operator-(const Vec3f& a, const Vec3f& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PSK_HD inline Vec3f operator*(float s, const Vec3f& a) { return {s * a.x, s * a.y, s * a.z}; }
PSK_HD inline float dot(const Vec3f& a, const Vec3f& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PSK_HD inline Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Distance of lattice neighbours at rest, in kernel radii.
inline constexpr float kRestSpacing = 0.5F;

/// (1 - r^2)^3, 0 beyond the radius: the poly6 kernel without its constant.
PSK_HD inline float weight(float squared) {
  const float t = 1 - squared;
  return t > 0 ? t * t * t : 0.0F;
}

/// What turns sums of weights into densities over the rest density.
struct KernelConstants {
  float per_weight;       ///< density ratio of one unit of weight: 1 / sum of the weights of the lattice at rest
  float slope;            ///< of the density ratio along r: - slope (1 - r)^2 (spiky)
  float wall;             ///< factor of covered_by_plane
  float tensile_inverse;  ///< 1 / weight at the distance where the artificial pressure has its nominal strength
};

/// Part of a continuous kernel beyond a plane at distance d of its centre: the integral of
/// 315/256 (1 - z^2)^4 from d to 1. @param d  >= 0
PSK_HD inline float covered_by_plane(float d) {
  if (d >= 1) return 0;
  const float s = d * d;
  const float to_d = d * (1 + s * (-4.0F / 3 + s * (6.0F / 5 + s * (-4.0F / 7 + s * (1.0F / 9)))));
  return 0.5F - 315.0F / 256 * to_d;
}

/// What the spiky kernel's gradient sums up to beyond that plane, towards it: its integral over the plane,
/// 30 times the integral of r (1 - r)^3 from d to 1. A fluid at rest whose pressure goes on behind the plane presses as
/// much: whatever else walls did would drive it round.
PSK_HD inline float push_of_plane(float d) {
  if (d >= 1) return 0;
  const float u = 1 - d;
  return (u * u) * (u * u) * (7.5F - 6 * u);
}

/// Sums over a cubic lattice at rest, in double.
inline KernelConstants make_kernel_constants() {
  constexpr double kTensileDistance = 0.2;
  const double a = kRestSpacing;
  double all = 0;
  double beyond_wall = 0;  // of a particle half a spacing from a wall
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) {
        const double t = 1 - a * a * (x * x + y * y + z * z);
        if (t <= 0) continue;
        all += t * t * t;
        if (x < 0) beyond_wall += t * t * t;
      }
  KernelConstants k{};
  k.per_weight = static_cast<float>(1 / all);
  // The constants of the kernels are 315 / (64 pi) for poly6 and 45 / pi for the slope of spiky.
  k.slope = static_cast<float>(64.0 / 7 / all);
  k.wall = static_cast<float>(beyond_wall / all) / covered_by_plane(kRestSpacing / 2);
  const double t = 1 - kTensileDistance * kTensileDistance;
  k.tensile_inverse = static_cast<float>(1 / (t * t * t));
  return k;
}

/// The walls within a kernel radius of a particle, one along an axis at most, and the images of others in them. An
/// image is never nearer than what it is the image of.
struct Mirrors {
  int near = 0;         ///< bit a: there is a wall across axis a
  Vec3f twice_plane{};  ///< twice its coordinate

  /// From the image of `other` in the walls of `set` to `p`.
  [[nodiscard]] PSK_HD Vec3f from_image(const Vec3f& p, const Vec3f& other, int set) const {
    return {(set & 1) != 0 ? p.x + other.x - twice_plane.x : p.x - other.x,
            (set & 2) != 0 ? p.y + other.y - twice_plane.y : p.y - other.y,
            (set & 4) != 0 ? p.z + other.z - twice_plane.z : p.z - other.z};
  }
  /// A vector as the walls of `set` show it.
  [[nodiscard]] PSK_HD static Vec3f turned(const Vec3f& v, int set) {
    return {(set & 1) != 0 ? -v.x : v.x, (set & 2) != 0 ? -v.y : v.y, (set & 4) != 0 ? -v.z : v.z};
  }
};

/// The part of a kernel that the obstacle covers, as a density ratio, and its gradient.
struct Cover {
  float share = 0;
  Vec3f gradient{};
};

/// The tank and the obstacle, in kernel radii.
struct Solids {
  Vec3f tank{};      ///< upper corner; the lower one is 0; sides > 2
  float gap = 0;     ///< particles stay so far inside
  Vec3f centre{};    ///< of the obstacle
  float radius = 0;  ///< of the obstacle; 0: there is none

  /// The nearest place that is allowed; the tank has the last word.
  [[nodiscard]] PSK_HD Vec3f confined(Vec3f p) const {
    if (radius > 0) {
      const Vec3f d = p - centre;
      const float squared = dot(d, d);
      const float least = radius + gap;
      if (squared < least * least) {
        const float r = std::sqrt(squared);
        p = r > 0 ? centre + least / r * d : centre + Vec3f{0, least, 0};
      }
    }
    const auto clamped = [this](float v, float upper) { return v < gap ? gap : v > upper - gap ? upper - gap : v; };
    return {clamped(p.x, tank.x), clamped(p.y, tank.y), clamped(p.z, tank.z)};
  }

  [[nodiscard]] PSK_HD Mirrors mirrors(const Vec3f& p) const {
    Mirrors out;
    const auto look = [&out](float v, float upper, int bit, float& twice) {
      if (v < 1) {
        out.near |= bit;
      } else if (upper - v < 1) {
        out.near |= bit;
        twice = 2 * upper;
      }
    };
    look(p.x, tank.x, 1, out.twice_plane.x);
    look(p.y, tank.y, 2, out.twice_plane.y);
    look(p.z, tank.z, 4, out.twice_plane.z);
    return out;
  }

  /// The obstacle's surface counts as the plane that touches it.
  [[nodiscard]] PSK_HD Cover cover(const Vec3f& p, const KernelConstants& k) const {
    if (!(radius > 0)) return {};
    const Vec3f d = p - centre;
    const float squared = dot(d, d);
    if (squared >= (radius + 1) * (radius + 1) || !(squared > 0)) return {};
    const float r = std::sqrt(squared);
    const float distance = r > radius ? r - radius : 0.0F;
    return {k.wall * covered_by_plane(distance), -push_of_plane(distance) / r * d};
  }
};

}  // namespace pointskin::simulation
