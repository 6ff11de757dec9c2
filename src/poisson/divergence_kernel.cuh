// Divergence on a GPU, one warp for 4 bricks, with the bits of DivergenceOfBricks.
#pragma once

#include <cstdint>

#include "exec/cuda_primitives.cuh"
#include "octree/corner_tile.cuh"
#include "poisson/divergence_of_bricks.hpp"
#include "poisson/splat_kernel.cuh"

namespace pointskin::poisson {

/// Which of the cells around the bricks are leaves, found by all lanes of a warp together.
/// @returns for a lane's corner, bit t: the cell at offset slot(t) - 1 is a leaf
__device__ inline int leaves_around_corners(const Divergence& divergence, std::int32_t first, int lane) {
  const octree::LevelView& level = divergence.level;
  const octree::CellAround cell(lane < octree::kNeighbours ? lane : 0);
  unsigned around = 0;  // of the lane's brick, in the order of CellAround
  PSK_UNROLL
  for (int k = 0; k < octree::kTileBricks; ++k) {
    bool is_leaf = false;
    if (lane < octree::kNeighbours) {
      const std::int32_t brick = octree::neighbour_of_brick(level, first + k, cell.neighbour);
      is_leaf = brick >= 0 && divergence.is_leaf(8 * brick + cell.slot);
    }
    const unsigned leaves = __ballot_sync(~0U, is_leaf);
    if (k == lane >> 3) around = leaves;
  }
  int leaves = 0;
  PSK_UNROLL
  for (int t = 0; t < 8; ++t) leaves |= static_cast<int>(around >> octree::CellAround::index(lane & 7, t) & 1) << t;
  return leaves;
}

/// All corners of 4 bricks, a lane each.
struct DivergenceOfTile {
  Divergence divergence;

  struct Shared {
    octree::CornerTile corners[3];
  };

  __device__ void operator()(std::int64_t tile, int lane, Shared& shared) const {
    const octree::LevelView& level = divergence.level;
    const auto first = static_cast<std::int32_t>(octree::kTileBricks * tile);
    const octree::TileSource source(level, first, lane);
    const int leaves = leaves_around_corners(divergence, first, lane);
    float sum = 0;
    if (__ballot_sync(~0U, leaves != 0) != 0) {
      PSK_UNROLL
      for (int axis = 0; axis < 3; ++axis) source.load(divergence.field.axis[axis].data, shared.corners[axis]);
      __syncwarp();
      if (leaves != 0) {
        PSK_UNROLL
        for (int axis = 0; axis < 3; ++axis)
          sum += divergence.along(axis, leaves, shared.corners[axis].around(lane).in_registers());
      }
    }
    if (first + (lane >> 3) < level.bricks) divergence.b[std::int64_t{8} * first + lane] = sum;
  }
};

inline void find_divergence(exec::Cuda& ex, const Divergence& divergence) {
  for_each_warp(ex, "splat.divergence", octree::tiles_of(divergence.level), DivergenceOfTile{divergence});
}

}  // namespace pointskin::poisson
