// The neighbours of particles, and their images in walls.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "kernels.hpp"
#include "step.hpp"

namespace pointskin::simulation::step {

/// Neighbours of all particles. Neighbour k of particle i is at i across + k along: a GPU reads one k of many particles
/// at once, a CPU all k of one.
struct NeighbourLists {
  ArrayView<std::int32_t> list;
  ArrayView<std::uint8_t> count;  // found, at most kMostNeighbours + 1
  std::int64_t across = 0, along = 0;

  [[nodiscard]] PSK_HD int size(std::int64_t i) const {
    return count[i] < kMostNeighbours ? count[i] : kMostNeighbours;
  }
  [[nodiscard]] PSK_HD std::int32_t& at(std::int64_t i, int k) const { return list[i * across + k * along]; }
};

/// Calls visit(j, d, squared, set) for every neighbour j of particle i and every image of one (of i itself, too) within
/// the radius; `set` says in which walls, 0 the particle itself. d leads from it to i. The order is fixed.
template <class Visit>
PSK_HD void for_each_near(const NeighbourLists& neighbours, ArrayView<const Vec3f> place, const Mirrors& mirrors,
                          std::int64_t i, const Visit& visit) {
  const Vec3f p = place[i];
  const int n = neighbours.size(i);
  const auto visit_images = [&](std::int32_t j, const Vec3f& other) {
    for (int set = mirrors.near; set != 0; set = (set - 1) & mirrors.near) {
      const Vec3f d = mirrors.from_image(p, other, set);
      const float squared = dot(d, d);
      if (squared < 1) visit(j, d, squared, set);
    }
  };
  for (int k = 0; k < n; ++k) {
    const std::int32_t j = neighbours.at(i, k);
    const Vec3f other = place[j];
    const Vec3f d = p - other;
    const float squared = dot(d, d);
    if (!(squared < 1)) continue;
    visit(j, d, squared, 0);
    if (mirrors.near != 0) visit_images(j, other);
  }
  if (mirrors.near != 0) visit_images(static_cast<std::int32_t>(i), p);
}

/// Unit vector from neighbour to particle and how far apart they are. Particles at one place part along x, by their
/// ids.
struct Apart {
  Vec3f direction;
  float distance;
};
PSK_HD inline Apart apart(const Vec3f& d, float squared, bool first) {
  constexpr float kOnePlace = 1e-12F;
  if (squared < kOnePlace) return {{first ? -1.0F : 1.0F, 0, 0}, 0};
  const float r = std::sqrt(squared);
  return {1 / r * d, r};
}

}  // namespace pointskin::simulation::step
