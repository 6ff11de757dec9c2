// Times of the phases of the pipeline, and the bandwidth that they come to. Bytes are a lower bound: what a phase must
// read once and write once, whatever its algorithm, for n points, N nodes of all levels (octree::OctreeData::nodes()),
// S cells of the finest level, V vertices and T triangles:
//   octree_sort      12 n positions, 8 n tie breaks; 8 n keys and 4 n order written
//   octree_build     8 n keys read; per brick of 8 nodes: neighbours 108, children 32, points 32, key 8, parent 4,
//   unknowns
//                    1 written, that is 23 N
//   density          12 n positions read; 4 N counts written
//   weigh            positions 12 n and normals 12 n read; normals 12 n, areas 4 n and depths 1 n written; the counts
//   are
//                    read where there are samples, at most 4 N
//   splat            positions and normals 24 n, areas 4 n, depths 1 n read; 4 N divergence written; the vector field
//   in
//                    between, three floats a node, is written and read: 24 N
//   screening        positions and areas 16 n read; 128 bytes a brick of the finest level with samples are left out: no
//                    function of n and N tells how many there are
//   solve            an iteration reads u and b, the neighbours (108 a brick), and writes u: 12 + 13.5 bytes a node;
//   times
//                    the iterations of the options. Screening and coarse levels, which take more, are left out
//   isovalue         positions and areas 16 n read; the field is read where there are samples, at most 4 N
//   extract          4 N field and 18 N octree (neighbours and children) read; 24 V positions and normals, 12 T
//   triangles
//                    written
// A phase far below the bandwidth of the memory is limited by something else, see docs/performance.md.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "exec/algorithms.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "on_spaces.hpp"
#include "poisson/density.hpp"
#include "poisson/divergence.hpp"
#include "poisson/resolution.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "reconstruct/point_hash.hpp"
#include "reconstruct/points.hpp"
#include "shapes.hpp"
#include "surface/extract.hpp"

namespace pointskin::bench {

/// Everything between the phases, for a knot of so many points at one depth.
template <exec::Space Exec>
struct Pipeline {
  detail::PointBuffers points;
  octree::Frame frame;
  exec::Buffer<Vec3f> unit;
  exec::Buffer<std::uint64_t> hashes, keys;
  poisson::Samples samples;
  octree::OctreeData tree;
  poisson::Density density;
  poisson::Resolution resolution;
  exec::Buffer<float> divergence;
  poisson::Screening screening;
  Options options;
  poisson::Solution solution;
  double isovalue = 0;

  Pipeline(Exec& ex, std::int64_t n, int depth) {
    options.depth = depth;
    points = detail::upload(ex, sample_surface(*make_shape("knot"), {.points = n}));
    frame = octree::fit_frame(ex, points.positions.cview(), options.scale);
    unit = exec::make_buffer<Vec3f>(ex, n);
    hashes = exec::make_buffer<std::uint64_t>(ex, n);
    for_each(ex, "unit", n, octree::ToUnit{frame, points.positions.cview(), unit.view()});
    for_each(ex, "hash", n, detail::HashPoint{points.positions.cview(), points.normals.cview(), hashes.view()});
    detail::SortedSamples sorted = detail::sort_into_cube(ex, points, frame);
    samples = std::move(sorted.samples);
    keys = std::move(sorted.keys);
    tree = octree::build_octree(ex, keys.cview(), depth);
    density = poisson::weigh_samples(ex, tree, {options.samples_per_node, options.confidence}, samples);
    resolution = poisson::find_resolution(ex, tree, samples);
    divergence = poisson::splat_divergence(ex, tree, samples.view(), resolution);
    screening = poisson::collapse_samples(ex, tree, samples.view());
    solution = solve(ex);
    isovalue = poisson::mean_at_samples(ex, tree, solution.u.cview(), samples.view());
  }

  poisson::Solution solve(Exec& ex) const {
    return poisson::solve_poisson(ex, resolution.view(tree), divergence.cview(), screening,
                                  {options.screening, options.iterations});
  }
  surface::Surface extract(Exec& ex) const {
    return surface::extract_surface(ex,
                                    field::FieldView{resolution.view(tree), solution.u.data(),
                                                     static_cast<float>(isovalue), true, resolution.bricks.data()},
                                    {});
  }
};

/// Made once for every number of points and depth.
template <exec::Space Exec>
Pipeline<Exec>& pipeline(Exec& ex, std::int64_t n, int depth) {
  static auto& kept = *new std::map<std::pair<std::int64_t, int>, std::unique_ptr<Pipeline<Exec>>>;  // see SpaceTraits
  std::unique_ptr<Pipeline<Exec>>& found = kept[{n, depth}];
  if (!found) found = std::make_unique<Pipeline<Exec>>(ex, n, depth);
  return *found;
}

/// What a phase does, and the bytes that it must move.
template <exec::Space Exec>
struct Phase {
  const char* name;
  void (*work)(Exec& ex, Pipeline<Exec>& p);
  double bytes_per_point, bytes_per_node;
};

template <exec::Space Exec>
void bench_phase(Exec& ex, benchmark::State& state, const Phase<Exec>& phase) {
  const std::int64_t n = state.range(0);
  Pipeline<Exec>& p = pipeline(ex, n, static_cast<int>(state.range(1)));
  time_on(ex, state, [&] { phase.work(ex, p); });
  const double bytes =
      phase.bytes_per_point * static_cast<double>(n) + phase.bytes_per_node * static_cast<double>(p.tree.nodes());
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes) * state.iterations());
}

template <exec::Space Exec>
void bench_extract(Exec& ex, benchmark::State& state) {
  Pipeline<Exec>& p = pipeline(ex, state.range(0), static_cast<int>(state.range(1)));
  std::int64_t mesh_bytes = 0;
  time_on(ex, state, [&] {
    const surface::Surface surface = p.extract(ex);
    mesh_bytes = 24 * surface.positions.size() + 12 * surface.triangles.size();
  });
  state.SetBytesProcessed((22 * p.tree.nodes() + mesh_bytes) * state.iterations());
}

/// Registers all phases for a space.
template <exec::Space Exec>
bool add_phases() {
  using P = Pipeline<Exec>;
  constexpr double kIterations = 8;  // of Options
  static const Phase<Exec> kPhases[] = {
      {"octree_sort", [](Exec& ex, P& p) { octree::sort_points(ex, p.unit.cview(), p.hashes.cview()); }, 32, 0},
      {"octree_build", [](Exec& ex, P& p) { octree::build_octree(ex, p.keys.cview(), p.options.depth); }, 8, 23},
      {"density", [](Exec& ex, P& p) { poisson::splat_density(ex, p.tree, p.samples.positions.cview()); }, 12, 4},
      {"weigh",
       [](Exec& ex, P& p) {
         poisson::weigh_samples(ex, p.tree, {p.options.samples_per_node, p.options.confidence}, p.samples);
         poisson::find_resolution(ex, p.tree, p.samples);
       },
       56, 4},
      {"splat", [](Exec& ex, P& p) { poisson::splat_divergence(ex, p.tree, p.samples.view(), p.resolution); }, 29, 28},
      {"screening", [](Exec& ex, P& p) { poisson::collapse_samples(ex, p.tree, p.samples.view()); }, 16, 0},
      {"solve", [](Exec& ex, P& p) { p.solve(ex); }, 0, 25.5 * kIterations},
      {"isovalue", [](Exec& ex, P& p) { poisson::mean_at_samples(ex, p.tree, p.solution.u.cview(), p.samples.view()); },
       16, 4},
  };
  const auto arguments = [](benchmark::internal::Benchmark* added) {
    added->Args({100'000, 7})
        ->Args({400'000, 8})
        ->Args({1'500'000, 9})
        ->ArgNames({"points", "depth"})
        ->Unit(benchmark::kMillisecond);
  };
  for (const Phase<Exec>& phase : kPhases) {
    add_benchmark<Exec>(
        phase.name, [&phase](Exec& ex, benchmark::State& state) { bench_phase(ex, state, phase); }, arguments);
  }
  add_benchmark<Exec>("extract", bench_extract<Exec>, arguments);
  return true;
}

}  // namespace pointskin::bench
