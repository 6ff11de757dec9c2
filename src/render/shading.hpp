// Colours: light, material, background. All in linear light; the picture is encoded to sRGB at the end.
#pragma once

#include <pointskin/render.hpp>

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/vec3d.hpp"

namespace pointskin::render_detail {

/// Linear red, green and blue, 0 to 1.
using Colour = Vec3d;

/// Linear light of the sRGB value `encoded` in [0, 1] (IEC 61966-2-1).
double decode_srgb(double encoded);

/// Turns linear light into sRGB bytes by a table.
class SrgbEncoder {
 public:
  SrgbEncoder();
  [[nodiscard]] std::uint8_t operator()(double linear) const;

 private:
  static constexpr std::size_t kTableSize = 1 << 14;
  std::array<std::uint8_t, kTableSize + 1> table_;
};

/// The background at `height` in [0, 1] from the bottom to the top of the picture.
Colour background(double height);

/// Clay of the colour `albedo` under a key light from the upper left of the viewer, a fill light from the right and a
/// sky, seen by the viewer.
/// @param normal  of the side that is seen, in the viewer's frame (right, up, towards the viewer), unit length
/// @param up      the mesh's up axis in the same frame
Colour shade(const Colour& albedo, const Vec3d& normal, const Vec3d& up);

/// Albedo of faces seen from outside, when the mesh has no colours, and of faces seen from behind.
Colour clay();
Colour behind();

/// Linear colour of every vertex from the attributes red, green and blue; empty if the mesh lacks one of them.
std::vector<Vec3f> vertex_colours(const Mesh& mesh);

}  // namespace pointskin::render_detail
