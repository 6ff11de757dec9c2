#include "core/format.hpp"
#include "fluid/surface.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>

#include "fluid/frames.hpp"
#include "fluid/sorted_particles.hpp"
#include "fluid/walls.hpp"

namespace pointskin::fluid {

namespace {

/// Particles so far from the origin that float does not tell neighbouring cells apart have no surface.
void check_resolution(const Bounds& box, double cell) {
  constexpr double kStep = 1.0 / (1 << 23);  // between floats, of their magnitude
  double reach = 0;
  for (const Vec3f& p : {box.lower, box.upper})
    for (const float c : {p.x, p.y, p.z}) reach = std::max(reach, std::abs(double{c}));
  if (reach * kStep > cell)
    throw Error(ErrorCode::invalid_input,
                fmt::format("particles lie {:.3g} from the origin, where float coordinates are {:.3g} apart, but cells "
                            "of the surface are {:.3g} wide; move the particles nearer to the origin, or leave the "
                            "offset to --shift auto",
                            reach, reach * kStep, cell));
}

}  // namespace

FluidFrame fit_frame(const Bounds& box, const FluidOptions& options, const std::optional<Bounds>& walls) {
  constexpr int kLeastDepth = 4;
  const double cell = options.cube_size * options.particle_radius;
  FluidFrame frame;
  frame.kernel_radius = 2 * options.smoothing_length * options.particle_radius;
  const double step = 4 * cell;
  const double margin = frame.kernel_radius + 3 * step;
  const double lower[3] = {box.lower.x, box.lower.y, box.lower.z};
  const double upper[3] = {box.upper.x, box.upper.y, box.upper.z};
  double side = 0;
  double origin[3] = {0, 0, 0};
  if (walls) {
    const double corner[3] = {walls->lower.x, walls->lower.y, walls->lower.z};
    for (std::size_t a = 0; a < 3; ++a) origin[a] = corner[a] + 0.5 * cell;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    frame.cube.lower[a] = origin[a] + std::floor((lower[a] - origin[a] - margin) / step) * step;
    side = std::max(side, upper[a] + margin - frame.cube.lower[a]);
  }
  frame.depth = kLeastDepth;
  while (frame.depth <= octree::kMaxDepth && std::ldexp(cell, frame.depth) < side) ++frame.depth;
  if (frame.depth > octree::kMaxDepth)
    throw Error(
        ErrorCode::over_limit,
        fmt::format("the particles reach over {:.3g} cells of the surface, more than 2^{} along an axis; choose "
                    "larger cells, or leave far particles out",
                    side / cell, octree::kMaxDepth));
  check_resolution(box, cell);
  frame.cube.size = std::ldexp(cell, frame.depth);
  return frame;
}

Walls walls_in(const octree::Frame& cube, int depth, const Bounds& box) {
  return {cube.to_unit(box.lower), cube.to_unit(box.upper), static_cast<float>(std::int64_t{1} << depth)};
}

double threshold_of(const FluidOptions& options) {
  if (options.surface_threshold != 0) return options.surface_threshold;
  return options.kernel == FluidKernel::anisotropic ? 0.2 : 1.0;
}

std::vector<std::string> Frame::names() const {
  std::vector<std::string> names;
  for (const ParticleValues& values : particles.values) names.push_back(values.name);
  return names;
}

ZhuBridsonField isotropic_field(const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options) {
  return {sorted.tree.view(), sorted.positions.cview(), static_cast<float>(frame.kernel_radius / frame.cube.size),
          static_cast<float>(threshold_of(options) / (2 * options.smoothing_length)),
          static_cast<float>(2 * options.smoothing_length / options.cube_size)};
}

AnisotropicField anisotropic_field(const Ellipsoids& ellipsoids, const FluidFrame& frame, const FluidOptions& options) {
  return {ellipsoids.tree.view(),
          ellipsoids.centres.cview(),
          ellipsoids.ellipsoids.cview(),
          static_cast<float>(frame.kernel_radius / frame.cube.size),
          static_cast<float>(threshold_of(options)),
          static_cast<float>(2 / options.cube_size)};
}

}  // namespace pointskin::fluid
