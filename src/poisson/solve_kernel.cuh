// Iterations on a GPU, with the bits of RelaxBricks: small levels in one cooperative launch, one thread a corner; large
// ones in a launch each, one warp for 4 bricks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "exec/cuda_primitives.cuh"
#include "octree/corner_tile.cuh"
#include "poisson/relax_bricks.hpp"

namespace pointskin::poisson {

/// Many iterations, one corner at a time. Corners that are no unknowns hold the interpolated value in both arrays.
struct RelaxCorners {
  static constexpr int kMostRounds = 64;

  LevelSystem system;
  float* u[2];  // round k reads the one of its parity
  ChebyshevStep steps[kMostRounds];

  [[nodiscard]] PSK_HD bool takes_part(int n) const { return (system.level.unknowns[n >> 3] >> (n & 7) & 1) != 0; }
  [[nodiscard]] PSK_HD CornerOperator prepare(int n) const { return {system, n}; }

  PSK_HD void operator()(int round, int n, const CornerOperator& corner) const {
    float value;
    const CornerResidual r = corner.residual(u[round & 1], value);
    float& out = u[~round & 1][n];
    out = steps[round].next(value, out, r.residual / r.diagonal);
  }
};

/// Collapsed samples of the 27 cells that touch the corners of each of a warp's bricks, in the order of CellAround.
struct SampleTile {
  CollapsedSample sample[octree::kTileBricks][octree::kNeighbours];
};

/// Stages the samples around the bricks of a tile. All lanes of a warp call it; they see each other's share after
/// __syncwarp().
__device__ inline void load_samples(const LevelSystem& system, std::int32_t first, int lane, SampleTile& out) {
  if (lane >= octree::kNeighbours) return;
  const octree::LevelView& level = system.level;
  const octree::CellAround cell(lane);
  std::int32_t place[octree::kTileBricks];
  PSK_UNROLL
  for (int k = 0; k < octree::kTileBricks; ++k) {
    const std::int32_t brick = octree::neighbour_of_brick(level, first + k, cell.neighbour);
    place[k] = brick < 0 ? -1 : system.screening.brick_index[brick];
  }
  CollapsedSample sample[octree::kTileBricks];
  PSK_UNROLL
  for (int k = 0; k < octree::kTileBricks; ++k) {
    sample[k].weight = 0;
    if (place[k] >= 0) sample[k] = system.screening.samples[8 * std::int64_t{place[k]} + cell.slot];
  }
  PSK_UNROLL
  for (int k = 0; k < octree::kTileBricks; ++k) out.sample[k][lane] = sample[k];
}

/// Adds the screening of the 8 cells around a lane's corner.
__device__ inline void screen(const LevelSystem& system, const SampleTile& samples, int lane,
                              const octree::CornerTile::Values& u, CornerResidual& out) {
  float residuals[8], diagonals[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const CollapsedSample sample = samples.sample[lane >> 3][octree::CellAround::index(lane & 7, s)];
    const Pull pull = pull_at_corner(sample, system.screening_scale, s, ~s & 7, u);
    residuals[s] = pull.residual;
    diagonals[s] = pull.diagonal;
  }
  out.add(residuals, diagonals);
}

/// One iteration of 4 bricks.
struct RelaxTile {
  LevelSystem system;
  ChebyshevStep chebyshev;
  const float* u;
  float* next;  // holds the u before

  struct Shared {
    SampleTile samples;
    octree::CornerTile corners;
  };

  __device__ void operator()(std::int64_t tile, int lane, Shared& shared) const {
    const octree::LevelView& level = system.level;
    const auto first = static_cast<std::int32_t>(octree::kTileBricks * tile);
    const std::int32_t brick = first + (lane >> 3);
    const std::int64_t n = std::int64_t{8} * first + lane;
    const bool exists = brick < level.bricks;
    const bool is_unknown = exists && (level.unknowns[brick] >> (lane & 7) & 1) != 0;
    if (first >= level.cell_bricks && __ballot_sync(~0U, is_unknown) == 0) return;  // ghosts seldom have unknowns

    // All that a lane will need is asked for before it waits for any of it.
    const float b = exists ? system.b[n] : 0;
    const float before = exists ? next[n] : 0;
    const std::uint64_t key = exists ? level.brick_key[brick] : 0;
    const octree::TileSource source(level, first, lane);
    unsigned screened = 0;
    if (system.screening_scale > 0) {
      const bool is_screened = exists && (system.screening.corners[brick] >> (lane & 7) & 1) != 0;
      screened = __ballot_sync(~0U, is_screened && is_unknown);
      if (screened != 0) load_samples(system, first, lane, shared.samples);
    }
    source.load(u, shared.corners);
    __syncwarp();
    if (!is_unknown) return;  // `next` holds the interpolated value already

    const octree::CornerTile::Values values = shared.corners.around(lane);
    CornerResidual r;
    r.residual = b - laplacian_at(system, key, lane & 7, false, values);
    if ((screened >> lane & 1) != 0) screen(system, shared.samples, lane, values, r);
    next[n] = chebyshev.next(values(0, 0, 0), before, r.residual / r.diagonal);
  }
};

inline void relax(exec::Cuda& ex, const LevelSystem& system, const std::vector<ChebyshevStep>& steps, float* from,
                  float* to) {
  constexpr const char* kLabel = "solve.relax";
  const auto rounds = static_cast<int>(steps.size());
  if (exec::is_one_launch(ex, system.level.nodes())) {
    for (int done = 0; done < rounds; done += RelaxCorners::kMostRounds) {  // an even number a sweep
      RelaxCorners relax{system, {from, to}, {}};
      const int some = std::min(rounds - done, RelaxCorners::kMostRounds);
      std::copy_n(steps.begin() + done, some, relax.steps);
      sweep(ex, kLabel, some, system.level.nodes(), relax);
    }
    return;
  }
  for (const ChebyshevStep& chebyshev : steps) {
    for_each_warp(ex, kLabel, octree::tiles_of(system.level), RelaxTile{system, chebyshev, from, to});
    std::swap(from, to);
  }
}

}  // namespace pointskin::poisson
