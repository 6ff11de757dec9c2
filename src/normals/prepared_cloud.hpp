// A cloud as the estimate of its normals sees it: sorted in an octree, with what the input says of sides.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/error.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "core/double3.hpp"
#include "exec/algorithms.hpp"
#include "normals/engine.hpp"
#include "normals/trial_size.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "octree/strays.hpp"
#include "reconstruct/point_hash.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::detail {

/// Points in the order of their keys.
struct PreparedCloud {
  octree::Frame frame;
  octree::OctreeData tree;
  exec::Buffer<std::int32_t> order;  ///< (n) index in the cloud
  exec::Buffer<Vec3f> positions;     ///< (n) in the unit cube; strays at its faces
  exec::Buffer<Vec3f> given;         ///< (n) normals of the cloud; empty: it has none
  std::int64_t strays = 0;
};

namespace prepare {

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
  PSK_HD std::int64_t operator()(std::int64_t i) const { return is_finite(values[i]) ? 0 : 1; }
};

template <exec::Space Exec>
exec::Buffer<Vec3f> upload_finite(Exec& ex, const std::vector<Vec3f>& values, const char* what) {
  auto out = exec::make_buffer<Vec3f>(ex, static_cast<std::int64_t>(values.size()));
  copy_to_device(ex, values.data(), out.view());
  const auto bad =
      exec::reduce<std::int64_t>(ex, "upload.check", out.size(), CountNotFinite{out.cview()}, exec::detail::Plus{});
  if (bad > 0)
    throw Error(ErrorCode::invalid_input,
                std::to_string(bad) + " points have " + what + " that are not finite; leave them out");
  return out;
}

/// What is said of the side of one sample: towards its sensor.
struct SeenFrom {
  octree::Frame frame;
  ArrayView<const Vec3f> positions, lines;
  ArrayView<const std::int32_t> order;
  ArrayView<const Vec3d> sensors;
  ArrayView<const Vec3f> towards;  // in the cloud's order; or none
  ArrayView<std::int32_t> evidence;

  PSK_HD void operator()(std::int64_t i) const {
    constexpr double kGrazing = 0.1;  // below this cosine the line's error decides
    const Double3 n = to_double(lines[i]);
    const Double3 view = towards.empty() ? towards_nearest(i) : to_double(towards[order[i]]);
    const double along = dot(n, view);
    const double limit = kGrazing * kGrazing * dot(view, view);
    evidence[i] = along * along > limit ? (along > 0 ? 1 : -1) : 0;
  }
  [[nodiscard]] PSK_HD Double3 towards_nearest(std::int64_t i) const {
    const Vec3f u = positions[i];
    const double p[3] = {frame.lower[0] + static_cast<double>(u.x) * frame.size,
                         frame.lower[1] + static_cast<double>(u.y) * frame.size,
                         frame.lower[2] + static_cast<double>(u.z) * frame.size};
    Double3 best{};
    double nearest = -1;
    for (std::int64_t s = 0; s < sensors.size; ++s) {
      const Double3 v{sensors[s][0] - p[0], sensors[s][1] - p[1], sensors[s][2] - p[2]};
      const double squared = dot(v, v);
      if (nearest >= 0 && squared >= nearest) continue;
      nearest = squared;
      best = v;
    }
    return best;
  }
};

/// What a given normal says of the side.
struct GivenSide {
  ArrayView<const Vec3f> given, lines;
  ArrayView<std::int32_t> evidence;
  PSK_HD void operator()(std::int64_t i) const {
    constexpr double kAcross = 0.1;
    const Double3 g = to_double(given[i]);
    const double along = dot(g, to_double(lines[i]));
    evidence[i] = along * along > kAcross * kAcross * dot(g, g) ? (along > 0 ? 1 : -1) : 0;
  }
};

}  // namespace prepare

/// @throws Error invalid_input, empty_result, over_limit
template <exec::Space Exec>
PreparedCloud prepare_cloud(Exec& ex, const Cloud& cloud) {
  constexpr std::int64_t kFewest = 3;
  const std::int64_t n = cloud.size();
  if (n < kFewest) throw Error(ErrorCode::empty_result, "fewer than 3 points have no normals");
  if (n > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the cloud has more than 2^31 - 1 points; thin it or split it");
  PreparedCloud out;
  exec::Buffer<Vec3f> world = prepare::upload_finite(ex, cloud.positions, "coordinates");
  exec::Buffer<Vec3f> given;
  if (cloud.has_normals()) given = prepare::upload_finite(ex, cloud.normals, "normals");
  const octree::StrayPoints strays = octree::find_strays(ex, world.cview());
  out.strays = strays.size();
  out.frame = octree::frame_around(strays.core, kTrialRoom);
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  auto hashes = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "octree.unit", n, octree::ToUnit{out.frame, world.cview(), unit.view()});
  for_each(ex, "octree.unit", n, prepare::ClampToCube{unit.view()});
  for_each(ex, "octree.hash", n,
           HashPoint{world.cview(), given.empty() ? world.cview() : given.cview(), hashes.view()});
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

}  // namespace pointskin::detail
