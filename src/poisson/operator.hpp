// The matrix-free operator of one level: Laplacian plus screening, for all 8 corners of a brick at once.
#pragma once

#include <cstdint>

#include "octree/keys.hpp"
#include "octree/neighbourhood.hpp"
#include "octree/view.hpp"
#include "poisson/screening.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {

/// One level's linear system  A u = b, in units of h:  A = Laplacian + screening.
struct LevelSystem {
  octree::LevelView level;
  const float* b = nullptr;  ///< divergence, (nodes of the level)
  ScreeningView screening;
  float screening_scale = 0;  ///< w 4^(d - D): turns a collapsed weight into a matrix weight; 0: no screening
  AxisRowsF rows{};           ///< for corners on the cube's faces
};

/// Residual b - A u and a diagonal that bounds A: the diagonal matrix minus A is positive semidefinite, so all
/// eigenvalues of diagonal^-1 A lie in [0, 1].
struct BrickResidual {
  float residual[8];
  float diagonal[8];
};

/// Sum of the 12 edge and 8 corner neighbours with their coefficients, and the corner itself.
PSK_HD inline float laplacian_inside(const octree::Neighbourhood& u, int x, int y, int z) {
  constexpr auto kCentre = static_cast<float>(InsideLaplacian::kCentre);
  constexpr auto kEdge = static_cast<float>(InsideLaplacian::kEdge);
  constexpr auto kCorner = static_cast<float>(InsideLaplacian::kCorner);
  const float edges =
      ((u.at(x - 1, y - 1, z) + u.at(x - 1, y + 1, z)) + (u.at(x + 1, y - 1, z) + u.at(x + 1, y + 1, z))) +
      ((u.at(x - 1, y, z - 1) + u.at(x - 1, y, z + 1)) + (u.at(x + 1, y, z - 1) + u.at(x + 1, y, z + 1))) +
      ((u.at(x, y - 1, z - 1) + u.at(x, y - 1, z + 1)) + (u.at(x, y + 1, z - 1) + u.at(x, y + 1, z + 1)));
  const float corners = ((u.at(x - 1, y - 1, z - 1) + u.at(x - 1, y - 1, z + 1)) +
                         (u.at(x - 1, y + 1, z - 1) + u.at(x - 1, y + 1, z + 1))) +
                        ((u.at(x + 1, y - 1, z - 1) + u.at(x + 1, y - 1, z + 1)) +
                         (u.at(x + 1, y + 1, z - 1) + u.at(x + 1, y + 1, z + 1)));
  return kCentre * u.at(x, y, z) + kEdge * edges + kCorner * corners;
}

/// Side of coordinate c of a corner of level `depth`.
PSK_HD inline int side_of(std::int32_t c, int depth) {
  return static_cast<int>(c == 0 ? AxisSide::lower_face : c == (1 << depth) ? AxisSide::upper_face : AxisSide::inside);
}

/// The same for a corner on the cube's faces: rows with one cell missing (natural boundary condition).
PSK_HD inline float laplacian_at_face(const LevelSystem& system, const octree::Neighbourhood& u,
                                      const octree::Coordinates& corner, int slot) {
  const int depth = system.level.depth;
  const int sides[3] = {side_of(corner.x, depth), side_of(corner.y, depth), side_of(corner.z, depth)};
  const AxisRowsF& rows = system.rows;
  float sum = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c) {
        const float mx = rows.mass[sides[0]][a];
        const float my = rows.mass[sides[1]][b];
        const float mz = rows.mass[sides[2]][c];
        const float coefficient = rows.stiffness[sides[0]][a] * my * mz + mx * rows.stiffness[sides[1]][b] * mz +
                                  mx * my * rows.stiffness[sides[2]][c];
        sum += coefficient *
               u.at(octree::slot_x(slot) + a - 1, octree::slot_y(slot) + b - 1, octree::slot_z(slot) + c - 1);
      }
  return sum;
}

/// True if some corner of the brick may lie on a face of the cube.
PSK_HD inline bool touches_faces(const octree::Coordinates& brick, int depth) {
  const std::int32_t last = depth == 0 ? 0 : 1 << (depth - 1);
  return brick.x == 0 || brick.y == 0 || brick.z == 0 || brick.x == last || brick.y == last || brick.z == last;
}

/// Adds the collapsed sample of the cell at offset (x, y, z) from the brick's first corner to the brick's corners.
PSK_HD inline void screen_cell(const CollapsedSample& sample, float scale, const octree::Neighbourhood& u, int x, int y,
                               int z, BrickResidual& out) {
  if (!(sample.weight > 0)) return;
  const float ax[2] = {1 - sample.x, sample.x};
  const float ay[2] = {1 - sample.y, sample.y};
  const float az[2] = {1 - sample.z, sample.z};
  float value = 0;
  PSK_UNROLL for (int s = 0; s < 8; ++s) {
    const int i = octree::slot_x(s);
    const int j = octree::slot_y(s);
    const int k = octree::slot_z(s);
    value += ax[i] * ay[j] * az[k] * u.at(x + i, y + j, z + k);
  }
  const float weight = scale * sample.weight;
  const float pull = weight * (0.5F - value);
  PSK_UNROLL for (int s = 0; s < 8; ++s) {
    const int i = octree::slot_x(s) - x;  // corner `slot` of the brick is corner (i, j, k) of the cell
    const int j = octree::slot_y(s) - y;
    const int k = octree::slot_z(s) - z;
    if (i < 0 || i > 1 || j < 0 || j > 1 || k < 0 || k > 1) continue;
    const float w = ax[i] * ay[j] * az[k];
    out.residual[s] += w * pull;
    out.diagonal[s] += w * weight;
  }
}

/// Adds the screening of all 27 cells around the brick's corners.
PSK_HD inline void screen_brick(const LevelSystem& system, std::int64_t brick, const octree::Neighbourhood& u,
                                BrickResidual& out) {
  const std::int32_t* bricks = system.level.neighbours + brick * octree::kNeighbours;
  PSK_UNROLL for (int x = -1; x <= 1; ++x) {
    PSK_UNROLL for (int y = -1; y <= 1; ++y) {
      PSK_UNROLL for (int z = -1; z <= 1; ++z) {
        const std::int32_t other =
            bricks[octree::neighbour_index(octree::brick_step(x), octree::brick_step(y), octree::brick_step(z))];
        const std::int32_t place = other < 0 ? -1 : system.screening.brick_index[other];
        if (place < 0) continue;
        const int slot = octree::slot_of(x & 1, y & 1, z & 1);
        screen_cell(system.screening.samples[8 * std::int64_t{place} + slot], system.screening_scale, u, x, y, z, out);
      }
    }
  }
}

/// Residual and bounding diagonal at the 8 corners of a brick. Entries of corners that are no unknowns mean nothing.
PSK_HD inline BrickResidual brick_residual(const LevelSystem& system, std::int64_t brick,
                                           const octree::Neighbourhood& u) {
  BrickResidual out;
  const octree::Coordinates at = octree::decode(system.level.brick_key[brick]);
  const bool faces = touches_faces(at, system.level.depth);
  PSK_UNROLL for (int s = 0; s < 8; ++s) {
    const int x = octree::slot_x(s);
    const int y = octree::slot_y(s);
    const int z = octree::slot_z(s);
    const float laplacian = faces ? laplacian_at_face(system, u, {2 * at.x + x, 2 * at.y + y, 2 * at.z + z}, s)
                                  : laplacian_inside(u, x, y, z);
    out.residual[s] = system.b[8 * brick + s] - laplacian;
    out.diagonal[s] = kLargestEigenvalue;
  }
  if (system.screening_scale > 0) screen_brick(system, brick, u, out);
  return out;
}

}  // namespace pointskin::poisson
