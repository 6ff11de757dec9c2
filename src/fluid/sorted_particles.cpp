#include "fluid/sorted_particles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mix_bits.hpp"
#include "exec/this_space.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::fluid {
namespace {

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

/// Cells of the unit cube as wide as a radius in it.
CellGrid cells_of(double radius) {
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

}  // namespace

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

template <exec::Space Exec>
Band find_isotropic_band(Exec& ex, const SortedParticles& sorted, const FluidFrame& frame, const FluidOptions& options,
                         const Walls& walls) {
  const ZhuBridsonField field = isotropic_field(sorted, frame, options);
  BandOptions band;
  band.depth = frame.depth;
  band.walls = walls;
  // A corner of a coarse cell is at most sqrt(3) finest cells from the middle of a drop.
  band.doubt = static_cast<float>(std::clamp(1.75 - threshold_of(options) / options.cube_size, 0.5, 1.25));
  band.particles_per_cell = options.smoothing_length * options.smoothing_length * options.smoothing_length;
  return find_band(ex, field, field.tree, field.positions, band);
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
                           const FluidOptions& options, const Walls& walls) {
  BandOptions band;
  band.depth = frame.depth;
  band.walls = walls;
  // Where there is nothing, the value is -threshold: that is no doubt.
  band.doubt = std::min(0.75F, 0.8F * field.threshold * field.cells);
  band.particles_per_cell = std::pow(options.smoothing_length, 3);
  return find_band(ex, field, field.tree, field.positions, band);
}

PSK_INSTANTIATE(sort_particles);
PSK_INSTANTIATE(find_isotropic_band);
PSK_INSTANTIATE(ellipsoids_of);
PSK_INSTANTIATE(find_anisotropic_band);

}  // namespace pointskin::fluid
