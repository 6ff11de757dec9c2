// Smoothing kernels, and the part of a kernel that walls cover. Lengths are in kernel radii.
// Sources: Mueller, Charypar & Gross, "Particle-based fluid simulation for interactive applications", 2003 (poly6 for
// the density, spiky for its gradient). Differs: solids are no particles. Walls mirror the fluid; what the
// obstacle covers of a kernel is a polynomial of the distance, scaled so that a lattice that rests against it lacks
// nothing.
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

/// Sum of the weights in water that has come to rest over that of the lattice with as many particles in its volume. At
/// rest there is no lattice, and with neighbours within two spacings their order counts. Measured
/// (docs/decisions/0034-volume-at-rest.md); what is pressed to the lattice's density settles by the difference.
inline constexpr double kRestOrder = 0.9945;

/// (1 - r^2)^3, 0 beyond the radius: the poly6 kernel without its constant.
PSK_HD inline float weight(float squared) {
  const float t = 1 - squared;
  return t > 0 ? t * t * t : 0.0F;
}

/// What turns sums of weights into densities over the rest density.
struct KernelConstants {
  float per_weight;       ///< density ratio of one unit of weight: 1 / sum of the weights at rest
  float slope;            ///< of the density ratio along r: - slope (1 - r)^2 (spiky)
  float wall;             ///< factor of covered_by_plane and moment_of_plane
  float surface;          ///< factor of missing_share
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

/// First moment of that part, towards the plane: the integral of z 315/256 (1 - z^2)^4. @param d  >= 0
PSK_HD inline float moment_of_plane(float d) {
  if (d >= 1) return 0;
  const float t = 1 - d * d;
  return 315.0F / 2560 * (t * t) * (t * t) * t;
}

/// The share of the density that a particle lacks because the water ends near it, out of the first moment of its
/// neighbours' weights (their sum times the offset, over the sum at rest), which is 0 in the midst of others. Where the
/// water ends at a plane the moment says how far away that is, and so how much is missing. A cube through the highest
/// layer of the lattice follows that; the moments inside of water at rest, 1/12 of that layer's, count for nothing.
/// Source of the idea that a free surface lacks density and must be given it: Schechter & Bridson, "Ghost SPH for
/// animating water", 2012. Differs: a formula instead of particles of air.
PSK_HD inline float missing_share(float moment, float factor) {
  constexpr float kMost = 0.5F;  // half of a kernel is beyond a plane through its centre
  const float share = factor * (moment * moment) * moment;
  return share < kMost ? share : kMost;
}

/// What the spiky kernel's gradient sums up to beyond that plane, towards it: its integral over the plane,
/// 30 times the integral of r (1 - r)^3 from d to 1. A fluid at rest whose pressure goes on behind the plane presses as
/// much: whatever else walls did would drive it round.
PSK_HD inline float push_of_plane(float d) {
  if (d >= 1) return 0;
  const float u = 1 - d;
  return (u * u) * (u * u) * (7.5F - 6 * u);
}

/// Sums over a cubic lattice, in double.
inline KernelConstants make_kernel_constants() {
  constexpr double kTensileDistance = 0.2;
  const double a = kRestSpacing;
  double lattice = 0;
  double beyond_wall = 0;  // of a particle half a spacing from a wall
  double moment = 0;       // of what is beyond
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) {
        const double t = 1 - a * a * (x * x + y * y + z * z);
        if (t <= 0) continue;
        lattice += t * t * t;
        if (x >= 0) continue;
        beyond_wall += t * t * t;
        moment -= a * x * t * t * t;
      }
  const double all = kRestOrder * lattice;
  const double layer = moment / all;
  KernelConstants k{};
  k.per_weight = static_cast<float>(1 / all);
  // The constants of the kernels are 315 / (64 pi) for poly6 and 45 / pi for the slope of spiky.
  k.slope = static_cast<float>(64.0 / 7 / all);
  k.wall = static_cast<float>(beyond_wall / all) / covered_by_plane(kRestSpacing / 2);
  k.surface = static_cast<float>(beyond_wall / all / (layer * layer * layer));
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

/// The part of a kernel that the obstacle covers, as a density ratio, its gradient and its first moment.
struct Cover {
  float share = 0;
  Vec3f gradient{};
  Vec3f moment{};  ///< away from the obstacle
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
    return {k.wall * covered_by_plane(distance), -push_of_plane(distance) / r * d,
            k.wall * moment_of_plane(distance) / r * d};
  }
};

}  // namespace pointskin::simulation
