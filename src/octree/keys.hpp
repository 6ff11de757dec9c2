// Morton keys: the bits of integer coordinates interleaved, x highest in every triple (the paper's shuffled xyz key).
// Source: Zhou et al. 2010, section 3.1; Wilhelms & Van Gelder, "Octrees for faster isosurface generation", 1992.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::octree {

/// Deepest level. Coordinates of corners reach 2^20 inclusive, so 21 bits an axis, 63 bits a key.
inline constexpr int kMaxDepth = 20;

/// Bits per axis of a point's key: one more level than the tree can have.
inline constexpr int kPointBits = 21;

/// Levels 0..kCompleteDepth are complete grids, so that the far field and the domain's boundary are resolved.
inline constexpr int kCompleteDepth = 5;

/// Integer coordinates in units of some level's cell width.
struct Coordinates {
  std::int32_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Coordinates&, const Coordinates&) = default;
};

/// Moves bit i of the lowest 21 bits to bit 3 i.
PSK_HD constexpr std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

/// The bits that spread_bits fills.
inline constexpr std::uint64_t kEveryThirdBit = 0x1249249249249249;

/// Inverse of spread_bits; other bits are ignored.
PSK_HD constexpr std::uint64_t gather_bits(std::uint64_t v) {
  v &= 0x1249249249249249;
  v = (v | v >> 2) & 0x10c30c30c30c30c3;
  v = (v | v >> 4) & 0x100f00f00f00f00f;
  v = (v | v >> 8) & 0x001f0000ff0000ff;
  v = (v | v >> 16) & 0x001f00000000ffff;
  v = (v | v >> 32) & 0x00000000001fffff;
  return v;
}

/// Key of non-negative coordinates below 2^21.
PSK_HD constexpr std::uint64_t encode(const Coordinates& c) {
  return spread_bits(static_cast<std::uint64_t>(c.x)) << 2 | spread_bits(static_cast<std::uint64_t>(c.y)) << 1 |
         spread_bits(static_cast<std::uint64_t>(c.z));
}

PSK_HD constexpr Coordinates decode(std::uint64_t key) {
  return {static_cast<std::int32_t>(gather_bits(key >> 2)), static_cast<std::int32_t>(gather_bits(key >> 1)),
          static_cast<std::int32_t>(gather_bits(key))};
}

/// Position of a node among its siblings: x is the highest bit.
PSK_HD constexpr int slot_of(int x, int y, int z) { return x << 2 | y << 1 | z; }
PSK_HD constexpr int slot_x(int slot) { return slot >> 2; }
PSK_HD constexpr int slot_y(int slot) { return slot >> 1 & 1; }
PSK_HD constexpr int slot_z(int slot) { return slot & 1; }

/// Index of an offset in {-1, 0, 1}^3 among the 27 neighbours; 13 is the node itself.
PSK_HD constexpr int neighbour_index(int dx, int dy, int dz) { return (dx + 1) * 9 + (dy + 1) * 3 + dz + 1; }
inline constexpr int kNeighbours = 27;
inline constexpr int kSelf = 13;

/// Key at depth kPointBits of a point of the unit cube; coordinates outside [0, 1) are clamped into the cube.
/// Scaling by a power of two and rounding down are exact, so every processor computes the same key.
PSK_HD inline std::uint64_t point_key(float x, float y, float z) {
  constexpr float kCells = static_cast<float>(1 << kPointBits);
  constexpr float kLast = kCells - 1;
  const auto cell = [](float v) {
    const float scaled = v * kCells;
    return static_cast<std::int32_t>(!(scaled > 0) ? 0.0F : scaled > kLast ? kLast : scaled);
  };
  return encode({cell(x), cell(y), cell(z)});
}

/// Depth-d cell key of a point key.
PSK_HD constexpr std::uint64_t cell_key(std::uint64_t point_key, int depth) {
  return point_key >> 3 * (kPointBits - depth);
}

}  // namespace pointskin::octree
