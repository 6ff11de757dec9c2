#include "normals/prepared_cloud.hpp"

#include <pointskin/error.hpp>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"
#include "normals/trial_size.hpp"
#include "octree/strays.hpp"
#include "reconstruct/point_hash.hpp"

namespace pointskin::normals {
namespace {

/// Into the cube: strays come to lie on its faces.
struct ClampToCube {
  ArrayView<Vec3f> positions;
  PSK_HD static float clamped(float v) { return v < 0 ? 0.0F : (v > 1 ? 1.0F : v); }
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    positions[i] = {clamped(p.x), clamped(p.y), clamped(p.z)};
  }
};

struct CountNotFinite {
  ArrayView<const Vec3f> values;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return detail::is_finite(values[i]) ? 0 : 1; }
};

template <exec::Space Exec>
exec::Buffer<Vec3f> upload_finite(Exec& ex, const std::vector<Vec3f>& values, const char* what) {
  auto out = exec::make_buffer<Vec3f>(ex, static_cast<std::int64_t>(values.size()));
  copy_to_device(ex, values.data(), out.view());
  const auto bad =
      exec::reduce<std::int64_t>(ex, "upload.check", out.size(), CountNotFinite{out.cview()}, exec::Plus{});
  if (bad > 0)
    throw Error(ErrorCode::invalid_input,
                std::to_string(bad) + " points have " + what + " that are not finite; leave them out");
  return out;
}

}  // namespace

template <exec::Space Exec>
PreparedCloud prepare_cloud(Exec& ex, const Cloud& cloud) {
  constexpr std::int64_t kFewest = 3;
  const std::int64_t n = cloud.size();
  if (n < kFewest) throw Error(ErrorCode::empty_result, "fewer than 3 points have no normals");
  if (n > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the cloud has more than 2^31 - 1 points; thin it or split it");
  PreparedCloud out;
  exec::Buffer<Vec3f> world = upload_finite(ex, cloud.positions, "coordinates");
  exec::Buffer<Vec3f> given;
  if (cloud.has_normals()) given = upload_finite(ex, cloud.normals, "normals");
  const octree::StrayPoints strays = octree::find_strays(ex, world.cview());
  out.strays = strays.size();
  out.frame = octree::frame_around(strays.core, kTrialRoom);
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  auto hashes = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "octree.unit", n, octree::ToUnit{out.frame, world.cview(), unit.view()});
  for_each(ex, "octree.unit", n, ClampToCube{unit.view()});
  for_each(ex, "octree.hash", n,
           detail::HashPoint{world.cview(), given.empty() ? world.cview() : given.cview(), hashes.view()});
  world.reset();
  octree::SortedPoints sorted = octree::sort_points(ex, unit.cview(), hashes.cview());
  hashes.reset();
  out.order = std::move(sorted.order);
  out.positions = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, unit.cview(), out.order.cview(), out.positions.view());
  if (!given.empty()) {
    out.given = exec::make_buffer<Vec3f>(ex, n);
    exec::gather(ex, given.cview(), out.order.cview(), out.given.view());
  }
  out.tree = octree::build_octree(ex, sorted.keys.cview(), trial_depth(n));
  return out;
}

PSK_INSTANTIATE(prepare_cloud);

}  // namespace pointskin::normals
