// Positions that get another origin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <pointskin/vector.hpp>

namespace pointskin {

/// A position whose origin moves by -`move`: the world position stays, to float. Monotone in each coordinate.
inline Vec3f rebased(const Vec3f& p, const Vec3d& move) {
  return {static_cast<float>(p.x + move[0]), static_cast<float>(p.y + move[1]), static_cast<float>(p.z + move[2])};
}

/// Points in a box around an origin.
struct PointsAround {
  Vec3d origin{0, 0, 0};
  Bounds box;
  std::int64_t points = 0;

  /// Adds points around the same origin; with 0 points there is no box.
  void add(const Bounds& of, std::int64_t count) {
    if (count == 0) return;
    if (points == 0) box = of;
    for (std::size_t a = 0; a < 3; ++a) {
      box.lower[a] = std::min(box.lower[a], of.lower[a]);
      box.upper[a] = std::max(box.upper[a], of.upper[a]);
    }
    points += count;
  }

  void rebase(const Vec3d& to) {
    const Vec3d move = origin - to;
    box = {rebased(box.lower, move), rebased(box.upper, move)};
    origin = to;
  }

  /// Distance of the middle of the box from a place, times the points: what float positions around that place would lose.
  [[nodiscard]] double loss_around(const Vec3d& place) const {
    const Vec3d lower = {box.lower.x, box.lower.y, box.lower.z};
    const Vec3d upper = {box.upper.x, box.upper.y, box.upper.z};
    double farthest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      farthest = std::max(farthest, std::abs(origin[a] + (lower[a] + upper[a]) / 2 - place[a]));
    return farthest * static_cast<double>(points);
  }

  /// Which of the two origins clouds that are merged get: true for that of `more`.
  [[nodiscard]] bool takes_origin_of(const PointsAround& more) const {
    const auto loss = [&](const Vec3d& place) { return loss_around(place) + more.loss_around(place); };
    return loss(more.origin) < loss(origin);
  }
};

}  // namespace pointskin
