// A frame's particles into a space, and its surface out of it.
#pragma once

#include <string>
#include <vector>

#include <pointskin/fluid.hpp>

#include "exec/space.hpp"
#include "fluid/surface.hpp"
#include "reconstruct/input.hpp"

namespace pointskin::fluid {

/// Particles of a frame with the memory that they are in.
struct Frame {
  exec::Buffer<Vec3f> positions;
  std::vector<exec::TypedBuffer> values;
  Particles particles;  ///< these
  [[nodiscard]] std::vector<std::string> names() const;
};

/// Brings the particles to the space; what is there already is borrowed.
/// @throws Error as FluidSurfacer::surface
template <exec::Space Exec>
Frame load_frame(Exec& ex, const detail::Input& input, const FluidOptions& options);

/// Moves a surface to the host.
/// @param names   of its values
/// @param report  receives download_ms and the peak memory
template <exec::Space Exec>
void download_surface(Exec& ex, FluidSurface made, const std::vector<std::string>& names, const Vec3d& origin,
                      Mesh& mesh, FluidReport& report);

}  // namespace pointskin::fluid
