// How much detail the points of a cloud hold, once for every space: their spacing and their noise.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <cmath>

#include "diagnose/sheets.hpp"
#include "exec/algorithms.hpp"
#include "field/distance.hpp"
#include "octree/even_depth.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "reconstruct/engine.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/weakness.hpp"

namespace pointskin::detail {

namespace measure {

/// By an octree of depth `depth`.
template <exec::Space Exec>
Detail by_octree(Exec& ex, const Cloud& cloud, const Options& options, int depth) {
  PointBuffers points = upload_some(ex, cloud);
  RunReport unused;
  const octree::Frame frame = fit_cube(ex, points, options, unused);
  SortedSamples sorted = sort_into_cube(ex, points, frame);
  points = {};
  const ArrayView<const Vec3f> positions = sorted.samples.positions.cview();
  const ArrayView<Vec3f> normals = sorted.samples.normals.view();
  if (!normals.empty()) field::normalise(ex, normals);
  const octree::OctreeData tree = octree::build_octree(ex, sorted.keys.cview(), depth);
  const poisson::Density density = poisson::splat_density(ex, tree, positions);
  const float per_cell =
      weakness::median_at(ex, positions, weakness::DensityAt{tree.view(), {density.depth, density.counts.data()}});
  const double cell = std::ldexp(frame.size, -tree.depth);
  return {frame.size, cell / std::sqrt(static_cast<double>(per_cell)),
          cell * diagnose::measure_noise(ex, tree.view(), positions, normals)};
}

}  // namespace measure

/// By an octree with about 1.5 points a cell, or more where Options::max_memory_bytes holds no finer one.
/// @throws Error as upload_some and frame_around; over_limit
/// O(n log n), most of it the sort and the octree. Deterministic.
template <exec::Space Exec>
Detail measure_detail(Exec& ex, const Cloud& cloud, const Options& options) {
  constexpr int kCoarsest = 4;
  for (int depth = octree::depth_of_even_samples(cloud.size());; --depth) {
    try {
      return measure::by_octree(ex, cloud, options, depth);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit || options.max_memory_bytes == 0 || depth <= kCoarsest) throw;
    }
  }
}

}  // namespace pointskin::detail
