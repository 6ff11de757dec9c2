// Light and background, in linear colours.
#pragma once

#include "render/colour.hpp"

namespace pointskin::render_detail {

/// The background at `height` in [0, 1] from the bottom to the top of the picture.
Colour background(double height);

/// Unit vector towards the key light, in the viewer's frame.
Vec3d key_light_direction();

/// Shares of the light that get to a place, in [0, 1].
struct Light {
  double open = 1;  ///< from all sides
  double key = 1;   ///< from the key light
};

/// How a surface is lit.
struct Lighting {
  Vec3d up{0, 1, 0};  ///< in the viewer's frame (right, up, towards the viewer)
  bool even = false;  ///< true: little contrast and no gloss, so that colours can be compared with a scale
};

/// Clay of the colour `albedo` under a key light from the upper left of the viewer, a fill light from the right, a rim
/// light from behind and a sky, seen by the viewer.
/// @param normal  of the side that is seen, in the viewer's frame, unit length
Colour shade(const Colour& albedo, const Vec3d& normal, const Light& light, const Lighting& lighting);

}  // namespace pointskin::render_detail
