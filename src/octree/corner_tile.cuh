// The corners around a few bricks, staged in shared memory by one warp.
//
// A warp looks after 4 bricks in a row, lane 8 k + s after corner s of brick k. A lane that fetched the 27 values
// around its corner for itself would ask the first-level cache for 8 lines a brick again and again; together the lanes
// ask for each of the 64 values around a brick once.
#pragma once

#include <cstdint>

#include "exec/cuda_primitives.cuh"
#include "octree/neighbourhood.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

using exec::kWarp;
inline constexpr int kTileBricks = kWarp / 8;

/// Tiles of a level; the last one may have fewer bricks.
inline std::int64_t tiles_of(const LevelView& level) {
  return (std::int64_t{level.bricks} + kTileBricks - 1) / kTileBricks;
}

/// Values at the 64 corners around each of 4 bricks.
class CornerTile {
 public:
  /// Values around one corner, all fetched at once.
  struct ValuesInRegisters {
    float value[kNeighbours];
    __device__ float operator()(int x, int y, int z) const { return value[neighbour_index(x, y, z)]; }
  };
  /// Values around one corner, at offsets -1, 0, 1 along each axis.
  struct Values {
    const float* centre;
    __device__ float operator()(int x, int y, int z) const { return centre[16 * x + 4 * y + z]; }

    [[nodiscard]] __device__ ValuesInRegisters in_registers() const {
      ValuesInRegisters values;
      PSK_UNROLL
      for (int x = -1; x <= 1; ++x) PSK_UNROLL
      for (int y = -1; y <= 1; ++y) PSK_UNROLL
      for (int z = -1; z <= 1; ++z) values.value[neighbour_index(x, y, z)] = (*this)(x, y, z);
      return values;
    }
  };
  [[nodiscard]] __device__ Values around(int lane) const {
    const int slot = lane & 7;
    return {value_ + first_of(lane >> 3) + Neighbourhood::index(slot_x(slot), slot_y(slot), slot_z(slot))};
  }

  /// Where the value at `index` of brick k's neighbourhood lies.
  __device__ float& at(int k, int index) { return value_[first_of(k) + index]; }

 private:
  /// Starts of the 4 bricks are shifted so that all lanes' corners lie in different memory banks.
  [[nodiscard]] __device__ static int first_of(int k) { return 64 * k + (k & 1) * 2 + (k >> 1) * 8; }

  float value_[64 * kTileBricks + 10];
};

/// Entry of a brick's row of neighbours; -1 also for bricks beyond the level's last.
__device__ inline std::int32_t neighbour_of_brick(const LevelView& level, std::int32_t brick, int neighbour) {
  return brick < level.bricks ? level.neighbours[std::int64_t{brick} * kNeighbours + neighbour] : -1;
}

/// Where a lane's share of a tile comes from: 2 of the 64 corners around each brick. All lanes of a warp make one.
class TileSource {
 public:
  /// @param first  first of the 4 bricks
  __device__ TileSource(const LevelView& level, std::int32_t first, int lane) : lane_(lane) {
    PSK_UNROLL
    for (int half = 0; half < 2; ++half) {
      const int x = (lane >> 4) - 1 + 2 * half;  // as Neighbourhood::index counts
      const int y = (lane >> 2 & 3) - 1;
      const int z = (lane & 3) - 1;
      const int neighbour = neighbour_index(brick_step(x), brick_step(y), brick_step(z));
      PSK_UNROLL
      for (int k = 0; k < kTileBricks; ++k) {
        const std::int32_t other = neighbour_of_brick(level, first + k, neighbour);
        node_[k][half] = other < 0 ? -1 : 8 * other + slot_of(x & 1, y & 1, z & 1);
      }
    }
  }

  /// Stages `values` of the level; corners that do not exist get 0. Lanes see each other's share after __syncwarp().
  __device__ void load(const float* values, CornerTile& tile) const {
    float share[kTileBricks][2];
    PSK_UNROLL
    for (int k = 0; k < kTileBricks; ++k) PSK_UNROLL
    for (int half = 0; half < 2; ++half) share[k][half] = node_[k][half] < 0 ? 0 : values[node_[k][half]];
    PSK_UNROLL
    for (int k = 0; k < kTileBricks; ++k) PSK_UNROLL
    for (int half = 0; half < 2; ++half) tile.at(k, kWarp * half + lane_) = share[k][half];
  }

 private:
  int lane_;
  std::int32_t node_[kTileBricks][2];
};

/// Cell that a lane below 27 looks at for a whole brick: the one at offset (x, y, z), each in -1..1, from the brick's
/// first corner, in the order of neighbour_index. Together they are all cells that touch the brick's corners.
struct CellAround {
  int neighbour, slot;

  __device__ explicit CellAround(int lane) {
    const int x = lane / 9 - 1;
    const int y = lane / 3 % 3 - 1;
    const int z = lane % 3 - 1;
    neighbour = neighbour_index(brick_step(x), brick_step(y), brick_step(z));
    slot = slot_of(x & 1, y & 1, z & 1);
  }

  /// Number of the cell at offset slot(s) - 1 from corner `corner`.
  [[nodiscard]] __device__ static int index(int corner, int s) {
    return neighbour_index(slot_x(corner) + slot_x(s) - 1, slot_y(corner) + slot_y(s) - 1,
                           slot_z(corner) + slot_z(s) - 1);
  }
};

}  // namespace pointskin::octree
