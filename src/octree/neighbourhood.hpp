// The 64 corners around a brick: its own 8 and one more on every side, loaded once and used for all 8 corners.
#pragma once

#include <cstdint>

#include "core/float8.hpp"
#include "core/host_device.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// Values at offsets -1..2 from the brick's first corner along each axis. Corners that do not exist hold 0.
struct Neighbourhood {
  float value[64];

  /// Index of offset (x, y, z), each in -1..2.
  PSK_HD static constexpr int index(int x, int y, int z) { return (x + 1) * 16 + (y + 1) * 4 + z + 1; }
  [[nodiscard]] PSK_HD float at(int x, int y, int z) const { return value[index(x, y, z)]; }
};

/// Brick that holds offset x of -1..2, as a step of -1, 0 or 1.
PSK_HD constexpr int brick_step(int x) { return x < 0 ? -1 : x > 1 ? 1 : 0; }

/// Loads `values` (of one level) around `brick`. 27 bricks of 32 bytes.
PSK_HD inline Neighbourhood load_neighbourhood(const LevelView& level, std::int64_t brick, const float* values) {
  Neighbourhood around;
  const std::int32_t* bricks = level.neighbours + brick * kNeighbours;
  PSK_UNROLL
  for (int x = -1; x <= 2; ++x) {
    PSK_UNROLL
    for (int y = -1; y <= 2; ++y) {
      PSK_UNROLL
      for (int z = -1; z <= 2; ++z) {
        const std::int32_t other = bricks[neighbour_index(brick_step(x), brick_step(y), brick_step(z))];
        around.value[Neighbourhood::index(x, y, z)] =
            other < 0 ? 0 : values[std::int64_t{8} * other + slot_of(x & 1, y & 1, z & 1)];
      }
    }
  }
  return around;
}

#if PSK_WIDE

/// The same for all 8 corners at once: values at offset (x, y, z), each in -1..1, from every corner of the brick.
struct NeighbourLanes {
  Float8 value[kNeighbours];
  PSK_INLINE const Float8& operator()(int x, int y, int z) const { return value[neighbour_index(x, y, z)]; }
};

/// Turns values of whole bricks around (before, own, after; `stride` apart) into those at offsets -1, 0, 1 along an
/// axis.
template <int Axis>
PSK_INLINE void step_along(Float8* bricks, int stride) {
  bricks[0] = between<Axis>(bricks[0], bricks[stride]);
  bricks[2 * stride] = between<Axis>(bricks[stride], bricks[2 * stride]);
}

/// Loads `values` (of one level) around `brick`: 27 bricks of 32 bytes, then one axis after another.
PSK_INLINE void load_lanes(const LevelView& level, std::int64_t brick, const float* values, NeighbourLanes& out) {
  const std::int32_t* bricks = level.neighbours + brick * kNeighbours;
  PSK_UNROLL
  for (int j = 0; j < kNeighbours; ++j)
    out.value[j] = bricks[j] < 0 ? Float8{} : load8(values + std::int64_t{8} * bricks[j]);
  PSK_UNROLL
  for (int i = 0; i < 9; ++i) step_along<0>(out.value + i, 9);
  PSK_UNROLL
  for (int i = 0; i < 9; ++i) step_along<1>(out.value + i / 3 * 9 + i % 3, 3);
  PSK_UNROLL
  for (int i = 0; i < 9; ++i) step_along<2>(out.value + i * 3, 1);
}

#endif

}  // namespace pointskin::octree
