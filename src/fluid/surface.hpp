// From particles in a space to the surface around them, in the same space.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/fluid.hpp>

#include "core/array_view.hpp"
#include "core/typed_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"
#include "octree/frame.hpp"
#include "surface/extract.hpp"

namespace pointskin::fluid {

/// Values of the particles that the vertices are to get, in the order of the positions.
struct ParticleValues {
  std::string name;
  TypedView values;  ///< (n); where there are walls, float32
  int axis = -1;     ///< of which this is a vector's component, 0 to 2; -1: a scalar
};

/// Particles of one frame, in a space.
struct Particles {
  ArrayView<const Vec3f> positions;  ///< (n), world units, finite
  std::vector<ParticleValues> values{};
  std::optional<Bounds> bounds{};  ///< a box around all; unset: measured, one round trip
  std::optional<Bounds> walls{};   ///< a box around all that the fluid touches (fluid/walls.hpp); world units
  bool canonical = false;          ///< true: their order is the same whenever they are; false: it does not matter
};

/// The surface of a frame, in the space of its particles.
struct FluidSurface {
  surface::Surface mesh;                  ///< positions in world units
  std::vector<exec::TypedBuffer> values;  ///< (vertices) each, in the order and of the types of Particles::values
};

/// Lengths of FluidOptions in the cube of one frame.
struct FluidFrame {
  octree::Frame cube;
  int depth = 0;
  double kernel_radius = 0;  ///< world units
};

/// The cube around particles: finest cells exactly as wide as asked, their borders at multiples of four cells in world
/// coordinates, so that cells stay where they are from frame to frame.
/// @param walls  if there are any: the cells' borders keep half a cell from the lower ones (and from all, where the box
/// is a multiple of the cells), because a field that is 0 at a corner has its crossings there, wherever it would be
/// crossed along the wall
/// @throws Error over_limit if that takes more than 2^kMaxDepth cells along an axis
FluidFrame fit_frame(const Bounds& box, const FluidOptions& options, const std::optional<Bounds>& walls = {});

/// FluidOptions::surface_threshold, or its default.
double threshold_of(const FluidOptions& options);

/// Makes the surface. Fills the counts and the times of `report` between upload and download, for which it waits.
/// @throws Error as FluidSurfacer::surface
template <exec::Space Exec>
FluidSurface make_surface(Exec& ex, const Particles& particles, const FluidOptions& options, FluidReport& report);

}  // namespace pointskin::fluid
