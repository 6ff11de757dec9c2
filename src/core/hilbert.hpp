// Places along a Hilbert curve, on the host and in kernels: neighbours in its order are near each other, always.
// Source: Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.
#pragma once

#include <cstdint>

#include "core/vec3.hpp"

namespace pointskin {

/// Bits of a coordinate in a Hilbert key; a key has three times as many.
inline constexpr int kHilbertBits = 16;

/// Place of p along the Hilbert curve through 2^kHilbertBits cells an axis of the unit cube; p is moved into that.
PSK_HD inline std::uint64_t hilbert_key(const Vec3f& p) {
  constexpr float kCells = 1 << kHilbertBits;
  const auto cell = [](float v) {
    const float at = v * kCells;
    return at > 0 ? (at < kCells ? static_cast<std::uint32_t>(at) : (1U << kHilbertBits) - 1) : 0U;
  };
  std::uint32_t x[3] = {cell(p.x), cell(p.y), cell(p.z)};
  for (std::uint32_t bit = 1U << (kHilbertBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& v : x) {
      if ((v & bit) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t swapped = (x[0] ^ v) & below;
        x[0] ^= swapped;
        v ^= swapped;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t turned = 0;
  for (std::uint32_t bit = 1U << (kHilbertBits - 1); bit > 1; bit >>= 1)
    if ((x[2] & bit) != 0) turned ^= bit - 1;
  std::uint64_t key = 0;
  for (int bit = kHilbertBits - 1; bit >= 0; --bit)
    for (const std::uint32_t v : x) key = key << 1 | ((v ^ turned) >> bit & 1);
  return key;
}

}  // namespace pointskin
