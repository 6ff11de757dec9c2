#include "fluid/particle_tree.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::fluid {

CellGrid grid_around(const Bounds& box, double radius) {
  const Vec3d lower{box.lower.x, box.lower.y, box.lower.z};
  const Vec3d upper{box.upper.x, box.upper.y, box.upper.z};
  const double side = std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  CellGrid grid;
  for (grid.depth = 1;; ++grid.depth) {
    // A float of the unit cube is rounded by 2^-25 at most, the particles' coordinates are exact.
    const double width = radius * (1 + std::ldexp(1.0, grid.depth - 22) + std::ldexp(1.0, -16));
    grid.cube.size = std::ldexp(width, grid.depth);
    if (grid.cube.size >= side) break;
    if (grid.depth < octree::kMaxDepth) continue;
    grid.cube.size = side;
    break;
  }
  for (std::size_t a = 0; a < 3; ++a) grid.cube.lower[a] = 0.5 * (lower[a] + upper[a]) - 0.5 * grid.cube.size;
  return grid;
}

ParticleTreeView ParticleTree::view() const {
  ParticleTreeView out;
  out.cube = grid.cube;
  out.level.depth = grid.depth;
  out.level.cell_bricks = out.level.bricks = static_cast<std::int32_t>(brick_key.size());
  out.level.brick_key = brick_key.data();
  out.level.neighbours = neighbours.data();
  out.level.point_begin = point_begin.data();
  out.table = table.data();
  out.cell = cell.data();
  return out;
}

}  // namespace pointskin::fluid
