// Surfaces of particles: one frame of a fluid simulation after another becomes a closed mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include <pointskin/cloud.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// The function that the surface is a level set of.
enum class FluidKernel {
  isotropic,    ///< distance to the weighted mean of the particles around (Zhu & Bridson 2005)
  anisotropic,  ///< density of particles that are ellipsoids (Yu & Turk 2013): flatter sheets, sharper edges; slower
};

/// Lengths are in particle radii, as in splashsurf, whose names these are where they mean the same.
struct FluidOptions {
  double particle_radius = 0;  ///< world units, in (0, 1e18]: half the distance of particles at rest; each stands for
                               ///< the rest volume (2 particle_radius)^3
  FluidKernel kernel = FluidKernel::isotropic;
  double smoothing_length = 2;  ///< in [1, 8]; the kernel reaches twice as far
  double cube_size = 0.5;       ///< width of the finest cells, in [0.05, 4]
  /// 0: the default, which keeps the volume. isotropic: distance from the mean of the particles, in particle radii,
  /// in (0, 2], default 1. anisotropic: share of the density at rest, in (0, 1], default 0.2
  double surface_threshold = 0;
  int smoothing_iterations = 0;   ///< of weighted Laplacian smoothing, in [0, 1000]
  bool smoothing_weights = true;  ///< true: single particles and thin sheets are smoothed less
  double min_component = 0;       ///< pieces of the surface that enclose less are removed, bubbles are filled; in rest
                                  ///< volumes of a particle, >= 0; 0: all stay
  bool normals = true;            ///< true: the mesh carries vertex normals
  bool attributes = true;  ///< true: the mesh carries every attribute of the cloud, averaged with the kernel, or,
                           ///< if it is a label (is_label), that of the nearest particle
};

/// What a frame took. Times are milliseconds on the device's clock.
struct FluidReport {
  std::int64_t particles = 0;
  int depth = 0;                    ///< the finest cells are cube / 2^depth wide
  std::int64_t coarse_corners = 0;  ///< evaluated to find the surface
  std::int64_t fine_corners = 0;    ///< evaluated around the surface
  int rounds = 0;                   ///< in which cells were added that the first search had missed
  std::int64_t removed_components = 0;
  double upload_ms = 0, particles_ms = 0, field_ms = 0, extract_ms = 0, finish_ms = 0, download_ms = 0;
  std::int64_t device_peak_bytes = 0;  ///< largest sum of buffers held at once in the space that ran the work
};

/// Makes surfaces of frame after frame. Owns a device's stream and memory pool; a frame that is no larger than those
/// before takes no memory. Not safe for two threads at once; several may live side by side.
class FluidSurfacer {
 public:
  /// @throws Error device_unavailable if the device does not answer, usage for a negative number of threads
  explicit FluidSurfacer(Workspace workspace = {});
  ~FluidSurfacer();
  FluidSurfacer(FluidSurfacer&&) noexcept;
  FluidSurfacer& operator=(FluidSurfacer&&) noexcept;

  /// The surface of `particles` as a closed, 2-manifold, outward-oriented mesh, in the particles' coordinates, with
  /// vertices in Morton order. Normals of the particles do not count. Attributes keep name and type; a value that is
  /// missing or not finite does not count. O(n + cells near the surface). Deterministic: the same bytes for any thread
  /// count, any order of the particles, CPU or GPU.
  /// @throws Error usage (an option out of range), invalid_input (particles that are not finite, an attribute of
  /// another
  ///         length), empty_result (no particles; nothing above the threshold or min_component), over_limit (memory,
  ///         32-bit indices, more than 2^20 cells along an axis)
  Mesh surface(const Cloud& particles, const FluidOptions& options);

  /// The same into a mesh of the caller, whose memory is used again.
  /// @throws Error as above; the mesh is then valid but unspecified
  void surface(const Cloud& particles, const FluidOptions& options, Mesh& mesh);

  /// The same from particles in the memory of the workspace's device to a mesh there: neither is copied.
  DeviceMesh surface(const DevicePoints& particles, const FluidOptions& options);

  /// Report of the last frame.
  [[nodiscard]] const FluidReport& report() const;

  [[nodiscard]] const Device& device() const;

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// @throws Error usage, naming the option and its range, if an option is out of range
void validate(const FluidOptions& options);

}  // namespace pointskin
