#include "reconstruct/measure_detail.hpp"

#include <pointskin/error.hpp>

#include <cmath>
#include <utility>

#include "diagnose/sheets.hpp"
#include "exec/this_space.hpp"
#include "field/distance.hpp"
#include "octree/even_depth.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/weakness.hpp"

namespace pointskin::detail {
namespace {

/// By an octree of depth `depth`.
template <exec::Space Exec>
Detail by_octree(Exec& ex, const Input& input, const Options& options, int depth) {
  PointBuffers points = upload_some(ex, input);
  RunReport unused;
  const octree::Frame frame = fit_cube(ex, points, options, unused);
  SortedSamples sorted = sort_into_cube(ex, points, frame);
  points = {};
  const ArrayView<const Vec3f> positions = sorted.samples.positions.cview();
  const ArrayView<Vec3f> normals = sorted.samples.normals.view();
  if (!normals.empty()) field::normalise(ex, normals);
  const octree::OctreeData tree = octree::build_octree(ex, sorted.keys.cview(), depth);
  const poisson::Density density = poisson::splat_density(ex, tree, positions);
  const float per_cell = median_density(ex, tree, density, positions);
  const double cell = std::ldexp(frame.size, -tree.depth);
  return {frame.size, cell / std::sqrt(static_cast<double>(per_cell)),
          cell * diagnose::measure_noise(ex, tree.view(), positions, normals)};
}

}  // namespace

template <exec::Space Exec>
Detail measure_detail(Exec& ex, const Input& input, const Options& options) {
  constexpr int kCoarsest = 4;
  for (int depth = octree::depth_of_even_samples(input.size());; --depth) {
    try {
      return by_octree(ex, input, options, depth);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit || options.max_memory_bytes == 0 || depth <= kCoarsest) throw;
    }
  }
}

PSK_INSTANTIATE(measure_detail);

}  // namespace pointskin::detail
