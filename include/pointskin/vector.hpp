// Small fixed-size vectors used at the library's face.
#pragma once

#include <array>
#include <cstdint>

namespace pointskin {

/// Three floats without padding: 12 bytes, the layout of packed xyz data in files.
struct Vec3f {
  float x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};
static_assert(sizeof(Vec3f) == 12);

using Vec3d = std::array<double, 3>;

/// Corner ids of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<std::int32_t, 3>;

}  // namespace pointskin
