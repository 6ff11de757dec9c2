// Walls that particles touch: water ends at them, and goes on behind them as a mirror shows it.
//
// Without walls a surface is a distance from particles everywhere, and rounds the edges of what stands in a tank: the
// block of a dam break of 20,000 particles loses 1.8 % of its volume. With an image behind the wall of every particle
// near it, the field next to a wall is that of a fluid which does not end there, and what lies beyond is cut off.
// Images as in "mirror" boundaries of particle methods: Colagrossi & Landrini, "Numerical simulation of interfacial
// flows by smoothed particle hydrodynamics", 2003.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"

namespace pointskin::fluid {

struct Particles;

/// A box in the unit cube that the fluid lies in; by default there is none.
struct Walls {
  static constexpr float kNowhere = std::numeric_limits<float>::max();
  Vec3f lower{-kNowhere, -kNowhere, -kNowhere};
  Vec3f upper{kNowhere, kNowhere, kNowhere};
  float cells = 0;  ///< finest cells in the unit cube; 0: there are no walls

  /// Distance to the nearest wall, finest cells, positive inside.
  [[nodiscard]] PSK_HD float depth(const Vec3f& x) const {
    if (cells == 0) return kNowhere;
    const auto least = [](float a, float b) { return b < a ? b : a; };
    const float along_x = least(x.x - lower.x, upper.x - x.x);
    const float along_y = least(x.y - lower.y, upper.y - x.y);
    const float along_z = least(x.z - lower.z, upper.z - x.z);
    return cells * least(along_x, least(along_y, along_z));
  }
  /// The value of a field that ends at the walls.
  [[nodiscard]] PSK_HD float cut(float value, const Vec3f& x) const {
    const float inside = depth(x);
    return inside < value ? inside : value;
  }
};

/// `box` in the unit cube of a frame. @param depth  of its finest cells
Walls walls_in(const octree::Frame& cube, int depth, const Bounds& box);

/// Particles and, after them, their images.
struct MirroredParticles {
  exec::Buffer<Vec3f> positions;            ///< (n + images) world units
  std::vector<exec::Buffer<float>> values;  ///< (n + images) each
};

/// Adds the images of all particles within `reach` of faces of `particles.walls`, in edges and corners too: for one
/// near k faces of different axes 2^k - 1. In the order of the particles; components of vectors are turned
/// (ParticleValues::axis).
/// @param particles  values of type float32
/// @param reach  world units, > 0
/// Three launches, one a value, and one host round trip. Every bit is the same in every space.
template <exec::Space Exec>
MirroredParticles add_images(Exec& ex, const Particles& particles, float reach);

}  // namespace pointskin::fluid
