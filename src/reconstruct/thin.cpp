#include "reconstruct/thin.hpp"

#include <algorithm>

#include "exec/this_space.hpp"
#include "octree/frame.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::detail {
namespace {

struct Pick {
  octree::Frame frame;
  ArrayView<const Vec3f> positions, normals;
  ArrayView<Vec3f> picked_positions, picked_normals;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t from = i * positions.size / picked_positions.size;
    picked_positions[i] = frame.to_world(positions[from]);
    picked_normals[i] = normals[from];
  }
};

}  // namespace

template <exec::Space Exec>
Cloud thin_cloud(Exec& ex, const Input& input, const Options& options, std::int64_t count) {
  PointBuffers points = upload(ex, input);
  RunReport unused;
  const octree::Frame frame = fit_cube(ex, points, options, unused);
  const poisson::Samples samples = sort_into_cube(ex, points, frame).samples;
  const std::int64_t n = std::min(count, samples.positions.size());
  auto positions = exec::make_buffer<Vec3f>(ex, n);
  auto normals = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "thin", n,
           Pick{frame, samples.positions.cview(), samples.normals.cview(), positions.view(), normals.view()});
  Cloud few;
  download_array(ex, positions, few.positions);
  download_array(ex, normals, few.normals);
  return few;
}

PSK_INSTANTIATE(thin_cloud);

}  // namespace pointskin::detail
