// What is counted of pairs of samples and of triangles: the same where arrays hold a cloud and where a disk does.
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "diagnose/counts.hpp"

namespace pointskin::diagnose {

/// Looks at samples and those near them.
/// @tparam Samples  poisson::SamplesView, or what has such positions, normals and areas
template <class Samples>
struct LookAtPairs {
  const Samples& samples;
  int depth;  ///< of the octree

  /// At sample i, with those that follow it.
  template <class Sums>
  PSK_HD void look_at(std::int64_t i, Sums& tally) const {
    const std::int64_t n = samples.positions.size;
    for (int step = 1; step <= kFollowers && i + step < n; ++step) compare(i, i + step, tally);
    PSK_UNROLL
    for (int k = 0; k < kScatterSteps; ++k) {
      const std::int64_t other = i + scatter_step(k);
      if (other < n) scatter(k, i, other, tally);
    }
    add_up(i, tally);
  }
  [[nodiscard]] PSK_HD static std::int64_t scatter_step(int k) { return std::int64_t{1} << 2 * k; }

  /// Opposed normals are those of two sheets, or one of them is flipped. Sheets lie at different heights along the
  /// normals; two samples of one surface do so by chance, as often this way as that.
  template <class Sums>
  PSK_HD void compare(std::int64_t i, std::int64_t j, Sums& tally) const {
    constexpr double kAlikeCosine = 0.5;
    constexpr double kSteep = 0.35;  // across an edge, or from sheet to sheet
    const Vec3d n = to_double(samples.normals[i]);
    const Vec3d m = to_double(samples.normals[j]);
    const Vec3d d = to_double(samples.positions[j]) - to_double(samples.positions[i]);
    const double along_n = dot(n, d);
    const double along_m = dot(m, d);
    const double limit = kSteep * kSteep * dot(d, d);
    const bool are_neighbours = may_share_surface(i, j, dot(d, d));
    if (!are_neighbours || !(along_n * along_n < limit && along_m * along_m < limit)) return;
    const double cosine = dot(n, m);
    const bool opposed = cosine < -kAlikeCosine;
    const double behind = along_m - along_n;  // > 0: each lies behind the other
    tally.count(kAlike, cosine > kAlikeCosine);
    tally.count(kApart, opposed && behind > 0);
    tally.count(kFacing, opposed && behind < 0);
    tally.count(kAbreast, opposed && behind == 0);
  }

 private:
  /// Whether two samples are neighbours, as far as areas tell. Those without one are outliers, whose normals are random, or
  /// flipped ones of the surface, which lie as near to the next sample there as any: nearer than the width of kNear samples.
  /// Both areas are read before one is looked at: reads that wait for others take longer.
  [[nodiscard]] PSK_HD bool may_share_surface(std::int64_t i, std::int64_t j, double distance2) const {
    constexpr double kNear = 4;
    if (samples.areas.empty()) return true;
    const float area = samples.areas[i];
    const float other = samples.areas[j];
    if (area > 0 && other > 0) return true;
    const double cell = 1.0 / static_cast<double>(std::int64_t{1} << depth);
    return distance2 < kNear * kNear * static_cast<double>(area > other ? area : other) * (cell * cell);
  }

  /// Half the squared distance across the surface, to which even curvature does not add (poisson/trust.hpp).
  template <class Sums>
  PSK_HD void scatter(int k, std::int64_t i, std::int64_t j, Sums& tally) const {
    constexpr double kAgreement = 0.8;
    constexpr double kMost = 512;  // finest cells^2
    const Vec3d n = to_double(samples.normals[i]);
    const Vec3d m = to_double(samples.normals[j]);
    if (!(dot(n, m) > kAgreement)) return;
    const double across = 0.5 * static_cast<double>(std::int64_t{1} << depth) *
                          dot(n + m, to_double(samples.positions[j]) - to_double(samples.positions[i]));
    const double half = 0.5 * across * across;
    tally.add_fraction(kScatter + k, half < kMost ? half : kMost);
    tally.add(kScatterPairs + k, 1);
  }

  /// What the sample adds to the area, the vector area and the volume that are enclosed.
  template <class Sums>
  PSK_HD void add_up(std::int64_t i, Sums& tally) const {
    const double cell = 1.0 / static_cast<double>(std::int64_t{1} << depth);
    const double stands_for = samples.areas.empty() ? 1.0 / static_cast<double>(samples.positions.size)
                                                    : static_cast<double>(samples.areas[i]) * cell * cell;
    const double area = stands_for < 1 ? stands_for : 1.0;
    const Vec3d n = to_double(samples.normals[i]) * area;
    tally.add_fraction(kArea, area);
    tally.add_fraction(kVectorX, n.x);
    tally.add_fraction(kVectorY, n.y);
    tally.add_fraction(kVectorZ, n.z);
    tally.add_fraction(kFlux, dot(n, to_double(samples.positions[i]) - Vec3d{0.5, 0.5, 0.5}));
  }
};

/// A cell that holds fewer samples than these is looked at on a coarser level when samples are compared across its faces.
inline constexpr std::int32_t kFewSamples = 4;

/// Of the s-th sample that is looked at: a warp's do the same thing. It is compared across faces, or the density is looked at.
inline constexpr int kWarp = 32;
[[nodiscard]] PSK_HD inline bool looks_across(std::int64_t s) { return s / kWarp % kSparse != 0; }
/// The axis of these faces.
[[nodiscard]] PSK_HD inline int axis_across(std::int64_t s) { return static_cast<int>(s % 3); }

/// Looks at a triangle.
/// @param is_far  is_far(point of the unit cube): no sample is near
template <class IsFar, class Sums>
PSK_HD void look_at_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, const IsFar& is_far, Sums& tally) {
  constexpr float kNear = 1e-4F;  // vertices of caps lie 1/1000 of an edge, which is 1/16 at most, from a face
  const auto is_cap = [](float x, float y, float z) {
    return (x < kNear && y < kNear && z < kNear) || (x > 1 - kNear && y > 1 - kNear && z > 1 - kNear);
  };
  const Vec3d normal = cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
  const double area = 0.5 * std::sqrt(dot(normal, normal));
  tally.add_fraction(kSurface, area);
  if (is_far(Vec3f{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3}))
    tally.add_fraction(kFarSurface, area);
  if (is_cap(a.x, b.x, c.x) || is_cap(a.y, b.y, c.y) || is_cap(a.z, b.z, c.z)) tally.add_fraction(kCaps, area);
}

}  // namespace pointskin::diagnose
