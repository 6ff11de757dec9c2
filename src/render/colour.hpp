// Linear colours, and the sRGB bytes of pictures.
#pragma once

#include <pointskin/vector.hpp>

#include <array>
#include <cstdint>

#include "core/vec3.hpp"

namespace pointskin::render_detail {

/// Linear red, green and blue, 0 to 1.
using Colour = Vec3d;

/// Linear light of the sRGB value `encoded` in [0, 1], and back (IEC 61966-2-1).
double decode_srgb(double encoded);
double encode_srgb(double linear);

inline Colour from_srgb(double r, double g, double b) { return {decode_srgb(r), decode_srgb(g), decode_srgb(b)}; }
inline Colour multiply(const Colour& a, const Colour& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline Colour mix(const Colour& a, const Colour& b, double t) { return (1 - t) * a + t * b; }

/// Turns linear light into sRGB bytes by a table.
class SrgbEncoder {
 public:
  SrgbEncoder();
  [[nodiscard]] std::uint8_t operator()(double linear) const;

 private:
  static constexpr std::size_t kTableSize = 1 << 14;
  std::array<std::uint8_t, kTableSize + 1> table_;
};

}  // namespace pointskin::render_detail
