#include "fluid/surface.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "exec/this_space.hpp"
#include "fluid/band.hpp"
#include "fluid/mesh_graph.hpp"
#include "fluid/sorted_particles.hpp"
#include "fluid/values_at.hpp"
#include "fluid/walls.hpp"
#include "reconstruct/phase_clock.hpp"
#include "surface/volume.hpp"

namespace pointskin::fluid {
namespace {

struct ToWorld {
  octree::Frame cube;
  ArrayView<Vec3f> positions;
  PSK_HD void operator()(std::int64_t i) const { positions[i] = cube.to_world(positions[i]); }
};

/// What the surface is made of: the particles and, where there are walls, their images.
Particles with_images(const Particles& given, const MirroredParticles& mirrored) {
  if (!given.walls) return given;
  Particles all = given;
  all.positions = mirrored.positions.cview();
  for (std::size_t a = 0; a < all.values.size(); ++a) {
    const exec::Buffer<float>& values = mirrored.values[a];
    all.values[a].values = {AttributeType::float32, values.data(), nullptr, values.size()};
  }
  return all;
}

/// The band of the field that the options ask for.
template <exec::Space Exec>
Band find_band_of(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options,
                  const Walls& walls) {
  if (options.kernel == FluidKernel::isotropic) return find_isotropic_band(ex, sorted, frame, options, walls);
  const Ellipsoids ellipsoids = ellipsoids_of(ex, sorted, frame, options);
  return find_anisotropic_band(ex, anisotropic_field(ellipsoids, frame, options), frame, options, walls);
}

/// Everything that follows the extraction.
template <exec::Space Exec>
void finish(Exec& ex, const SortedParticles& sorted, const Particles& particles, const FluidFrame& frame,
            const FluidOptions& options, FluidReport& report, FluidSurface& out) {
  surface::Surface& mesh = out.mesh;
  if (options.min_component > 0) {
    const double in_cells = options.min_component * std::pow(2 / options.cube_size, 3);
    report.removed_components = remove_small_components(ex, frame.depth, in_cells, mesh);
    if (mesh.triangles.empty())
      throw Error(ErrorCode::empty_result,
                  "every piece of the surface is below the least volume; choose a smaller one");
  }
  const bool weighted = options.smoothing_iterations > 0 && options.smoothing_weights;
  const ParticlesView view{sorted.tree.view(), sorted.positions.cview(),
                           static_cast<float>(frame.kernel_radius / frame.cube.size)};
  exec::Buffer<float> weights;
  const ValueSources sources{view, sorted.order.cview(), particles.values};
  out.values = values_at(ex, sources, mesh.positions.cview(), weighted ? &weights : nullptr);
  Fans fans;
  if (options.smoothing_iterations > 0 || options.normals)
    fans = find_fans(ex, mesh.triangles.cview(), mesh.positions.size());
  if (options.smoothing_iterations > 0) {
    constexpr double kBulk = 13.0 / 8;  // crowding by particles within half of the kernel's radius
    const double crowd = kBulk * std::pow(options.smoothing_length, 3);
    if (weighted) to_smoothing_weights(ex, static_cast<float>(crowd), weights.view());
    smooth(ex, fans, mesh.triangles.cview(), weights.cview(), options.smoothing_iterations, mesh.positions);
    if (surface::sign_of_volume(ex, frame.depth, mesh) <= 0)
      throw Error(ErrorCode::empty_result,
                  "smoothing has drawn the surface together until it encloses nothing; choose fewer iterations");
  }
  if (options.normals) mesh.normals = normals_of(ex, fans, mesh.triangles.cview(), mesh.positions.cview());
  for_each(ex, "fluid.world", mesh.positions.size(), ToWorld{frame.cube, mesh.positions.view()});
}

}  // namespace

template <exec::Space Exec>
FluidSurface make_surface(Exec& ex, const Particles& given, const FluidOptions& options, FluidReport& report) {
  using detail::PhaseClock;
  if (given.positions.empty())
    throw Error(ErrorCode::empty_result, "there are no particles; nothing to make a surface of");
  PhaseClock clock(ex);
  const Bounds box = given.bounds ? *given.bounds : octree::box_around(ex, given.positions);
  const FluidFrame frame = fit_frame(box, options, given.walls);
  const MirroredParticles mirrored =
      given.walls ? add_images(ex, given, static_cast<float>(frame.kernel_radius)) : MirroredParticles{};
  const Particles particles = with_images(given, mirrored);
  const Walls walls = given.walls ? walls_in(frame.cube, frame.depth, *given.walls) : Walls{};
  SortedParticles sorted = sort_particles(ex, particles, frame);
  clock.lap(report.particles_ms);

  Band band = find_band_of(ex, sorted, frame, options, walls);
  report.particles = given.positions.size;
  report.depth = frame.depth;
  report.coarse_corners = band.coarse_corners;
  report.fine_corners = band.fine_corners;
  report.rounds = band.rounds;
  clock.lap(report.field_ms);

  FluidSurface out;
  out.mesh = surface::extract_surface(ex, band.field(), {.curvature = 0, .normals = false});
  if (out.mesh.triangles.empty())
    throw Error(ErrorCode::empty_result, "no place is inside of the surface; choose a larger threshold");
  band = {};
  clock.lap(report.extract_ms);

  report.removed_components = 0;
  finish(ex, sorted, particles, frame, options, report, out);
  clock.lap(report.finish_ms);
  clock.read();
  return out;
}

PSK_INSTANTIATE(make_surface);

}  // namespace pointskin::fluid
