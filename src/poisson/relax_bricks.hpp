// One iteration on the unknowns of a level.
#pragma once

#include <cstdint>

#include "poisson/chebyshev.hpp"
#include "poisson/operator.hpp"

namespace pointskin::poisson {

/// One iteration a brick at a time. A GPU has a kernel of its own for it (solve_kernel.cuh).
struct RelaxBricks {
  LevelSystem system;
  ChebyshevStep chebyshev;
  const float* u;
  float* next;  // holds the u before
  PSK_HD void operator()(std::int64_t brick) const {
    const int unknowns = system.level.unknowns[brick];
    if (unknowns == 0) return;  // `next` holds the interpolated values already
    const octree::Neighbourhood around = octree::load_neighbourhood(system.level, brick, u);
    const BrickResidual r = brick_residual(system, brick, around);
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      if ((unknowns >> s & 1) == 0) continue;
      const float value = around.at(octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      float& out = next[8 * brick + s];
      out = chebyshev.next(value, out, r.corner[s].residual / r.corner[s].diagonal);
    }
  }

#if PSK_WIDE
  /// 8 corners at once; bricks at the cube's faces have rows of their own.
  PSK_INLINE void wide(std::int64_t brick) const {
    const int unknowns = system.level.unknowns[brick];
    if (unknowns == 0) return;
    if (touches_faces(system.level.brick_key[brick], system.level.depth)) return (*this)(brick);
    octree::NeighbourLanes around;
    octree::load_lanes(system.level, brick, u, around);
    BrickResidual8 r;
    residual_lanes(system, brick, around, r);
    float* out = next + 8 * brick;
    const Float8 before = load8(out);
    store8(select(mask_of_bits(unknowns), chebyshev.next(around(0, 0, 0), before, r.residual / r.diagonal), before),
           out);
  }
#endif
};

}  // namespace pointskin::poisson
