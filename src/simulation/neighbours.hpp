// The neighbours of particles, and their images in walls.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "simulation/kernels.hpp"
#include "simulation/step.hpp"

namespace pointskin::simulation::step {

/// A particle's place with a number of its own: one read of 16 bytes.
struct alignas(16) Placed {
  Vec3f place;
  float value;
};

/// Neighbours of all particles, by lanes: lane j % kLanes has particle j. Neighbour k of list l, which is
/// that of lane l % kLanes of particle l / kLanes, is at l across + k along: a GPU reads one k of many lists at once, a
/// CPU all k of one.
template <int Lanes>
struct NeighbourLists {
  static constexpr int kLanes = Lanes;
  static constexpr int kMost = most_neighbours(Lanes);

  ArrayView<std::int32_t> list;
  ArrayView<std::uint8_t> count;  // found, at most kMost + 1
  std::int64_t across = 0, along = 0;

  [[nodiscard]] PSK_HD int size(std::int64_t l) const { return count[l] < kMost ? count[l] : kMost; }
  [[nodiscard]] PSK_HD std::int32_t& at(std::int64_t l, int k) const { return list[l * across + k * along]; }
};

/// Calls visit(j, value of j, d, squared, set) for every neighbour j of particle i that is in the list of a lane, and
/// every image of one (of i itself, too, for the first lane) within the radius; `set` says in which walls, 0 the
/// particle itself. d leads from it to i. The order is fixed.
template <int Lanes, class Visit>
PSK_HD void for_each_near(const NeighbourLists<Lanes>& neighbours, ArrayView<const Placed> particles,
                          const Mirrors& mirrors, std::int64_t i, int lane, const Visit& visit) {
  const Placed own = particles[i];
  const Vec3f p = own.place;
  const std::int64_t list = i * Lanes + lane;
  const int n = neighbours.size(list);
  const auto visit_images = [&](std::int32_t j, const Placed& other) {
    for (int set = mirrors.near; set != 0; set = (set - 1) & mirrors.near) {
      const Vec3f d = mirrors.from_image(p, other.place, set);
      const float squared = dot(d, d);
      if (squared < 1) visit(j, other.value, d, squared, set);
    }
  };
  for (int k = 0; k < n; ++k) {
    const std::int32_t j = neighbours.at(list, k);
    const Placed other = particles[j];
    const Vec3f d = p - other.place;
    const float squared = dot(d, d);
    if (!(squared < 1)) continue;
    visit(j, other.value, d, squared, 0);
    if (mirrors.near != 0) visit_images(j, other);
  }
  if (mirrors.near != 0 && lane == 0) visit_images(static_cast<std::int32_t>(i), own);
}

/// A sum over neighbours that is a vector.
struct VectorSum {
  Vec3f vector{};
  PSK_HD VectorSum operator+(const VectorSum& other) const { return {simulation::operator+(vector, other.vector)}; }
};

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
