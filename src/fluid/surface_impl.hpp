#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mix_bits.hpp"
#include "exec/algorithms.hpp"
#include "fluid/anisotropic_impl.hpp"
#include "fluid/band_impl.hpp"
#include "fluid/mesh_graph_impl.hpp"
#include "fluid/particle_tree_impl.hpp"
#include "fluid/surface.hpp"
#include "fluid/values_at.hpp"
#include "fluid/walls_impl.hpp"
#include "fluid/zhu_bridson.hpp"
#include "octree/octree_data.hpp"
#include "reconstruct/phase_clock.hpp"

namespace pointskin::fluid {
namespace make {

struct HashPosition {
  ArrayView<const Vec3f> positions;
  ArrayView<std::uint64_t> hashes;
  PSK_HD void operator()(std::int64_t i) const { hashes[i] = mix_vector(kHashSeed, positions[i]); }
};
struct HashValue {
  TypedView values;
  ArrayView<std::uint64_t> hashes;
  PSK_HD void operator()(std::int64_t i) const { hashes[i] = values.mixed_into(hashes[i], i); }
};

struct ToUnit {
  octree::Frame cube;
  ArrayView<const Vec3f> in;
  ArrayView<const std::int32_t> order;  // empty: as they are
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = cube.to_unit(in[order.empty() ? i : order[i]]); }
};

struct ToWorld {
  octree::Frame cube;
  ArrayView<Vec3f> positions;
  PSK_HD void operator()(std::int64_t i) const { positions[i] = cube.to_world(positions[i]); }
};

/// Particles in the unit cube, sorted for searches.
struct SortedParticles {
  ParticleTree tree;
  exec::Buffer<Vec3f> positions;     // in the order of the tree's keys
  exec::Buffer<std::int32_t> order;  // the caller's index of each
};

/// Cells of the unit cube as wide as a radius in it.
inline CellGrid cells_of(double radius) {
  CellGrid grid;
  for (grid.depth = 1; grid.depth < octree::kMaxDepth && std::ldexp(radius, grid.depth) < 1; ++grid.depth) {
  }
  grid.cube = {{0, 0, 0}, std::max(1.0, std::ldexp(radius, grid.depth))};
  return grid;
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> canonical_order(Exec& ex, const Particles& particles, ArrayView<const Vec3f> unit) {
  auto hashes = exec::make_buffer<std::uint64_t>(ex, unit.size);
  for_each(ex, "particles.hash", unit.size, HashPosition{particles.positions, hashes.view()});
  for (const ParticleValues& values : particles.values)
    for_each(ex, "particles.hash", unit.size, HashValue{values.values, hashes.view()});
  return octree::sort_points(ex, unit, hashes.cview()).order;
}

template <exec::Space Exec>
SortedParticles sort_particles(Exec& ex, const Particles& particles, const FluidFrame& frame) {
  const std::int64_t n = particles.positions.size;
  SortedParticles sorted;
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "particles.unit", n, ToUnit{frame.cube, particles.positions, {}, unit.view()});
  exec::Buffer<std::int32_t> canonical;
  if (!particles.canonical) {
    canonical = canonical_order(ex, particles, unit.cview());
    for_each(ex, "particles.unit", n, ToUnit{frame.cube, particles.positions, canonical.cview(), unit.view()});
  }
  sorted.tree = build_particle_tree(ex, unit.cview(), cells_of(frame.kernel_radius / frame.cube.size));
  sorted.positions = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, unit.cview(), sorted.tree.order.cview(), sorted.positions.view());
  if (particles.canonical) {
    sorted.order = std::move(sorted.tree.order);
  } else {
    sorted.order = exec::make_buffer<std::int32_t>(ex, n);
    exec::gather(ex, canonical.cview(), sorted.tree.order.cview(), sorted.order.view());
  }
  return sorted;
}

/// What the surface is made of: the particles and, where there are walls, their images.
inline Particles with_images(const Particles& given, const MirroredParticles& mirrored) {
  if (!given.walls) return given;
  Particles all = given;
  all.positions = mirrored.positions.cview();
  for (std::size_t a = 0; a < all.values.size(); ++a) {
    const exec::Buffer<float>& values = mirrored.values[a];
    all.values[a].values = {AttributeType::float32, values.data(), nullptr, values.size()};
  }
  return all;
}

inline ZhuBridsonField isotropic_field(const SortedParticles& sorted, const FluidFrame& frame,
                                       const FluidOptions& options) {
  return {sorted.tree.view(), sorted.positions.cview(), static_cast<float>(frame.kernel_radius / frame.cube.size),
          static_cast<float>(threshold_of(options) / (2 * options.smoothing_length)),
          static_cast<float>(2 * options.smoothing_length / options.cube_size)};
}

template <exec::Space Exec>
Band find_isotropic_band(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options,
                         const Walls& walls = {}) {
  const ZhuBridsonField field = isotropic_field(sorted, frame, options);
  BandOptions band;
  band.depth = frame.depth;
  band.walls = walls;
  // A corner of a coarse cell is at most sqrt(3) finest cells from the middle of a drop.
  band.doubt = static_cast<float>(std::clamp(1.75 - threshold_of(options) / options.cube_size, 0.5, 1.25));
  band.particles_per_cell = options.smoothing_length * options.smoothing_length * options.smoothing_length;
  return find_band(ex, field, field.tree, field.positions, band);
}

inline AnisotropicField anisotropic_field(const Ellipsoids& ellipsoids, const FluidFrame& frame,
                                          const FluidOptions& options) {
  return {ellipsoids.tree.view(),
          ellipsoids.centres.cview(),
          ellipsoids.ellipsoids.cview(),
          static_cast<float>(frame.kernel_radius / frame.cube.size),
          static_cast<float>(threshold_of(options)),
          static_cast<float>(2 / options.cube_size)};
}

template <exec::Space Exec>
Ellipsoids ellipsoids_of(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame,
                         const FluidOptions& options) {
  return find_ellipsoids(ex, sorted.tree, sorted.positions.cview(),
                         static_cast<float>(frame.kernel_radius / frame.cube.size),
                         std::pow(1 / options.smoothing_length, 3));
}

template <exec::Space Exec>
Band find_anisotropic_band(Exec& ex, const AnisotropicField& field, const FluidFrame& frame,
                           const FluidOptions& options, const Walls& walls = {}) {
  BandOptions band;
  band.depth = frame.depth;
  band.walls = walls;
  // Where there is nothing, the value is -threshold: that is no doubt.
  band.doubt = std::min(0.75F, 0.8F * field.threshold * field.cells);
  band.particles_per_cell = std::pow(options.smoothing_length, 3);
  return find_band(ex, field, field.tree, field.positions, band);
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
  }
  if (options.normals) mesh.normals = normals_of(ex, fans, mesh.triangles.cview(), mesh.positions.cview());
  for_each(ex, "fluid.world", mesh.positions.size(), ToWorld{frame.cube, mesh.positions.view()});
}

}  // namespace make

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
  const Particles particles = make::with_images(given, mirrored);
  const Walls walls = given.walls ? walls_in(frame.cube, frame.depth, *given.walls) : Walls{};
  make::SortedParticles sorted = make::sort_particles(ex, particles, frame);
  clock.lap(report.particles_ms);

  Band band = make::find_band_of(ex, sorted, frame, options, walls);
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
  make::finish(ex, sorted, particles, frame, options, report, out);
  clock.lap(report.finish_ms);
  clock.read();
  return out;
}

}  // namespace pointskin::fluid
