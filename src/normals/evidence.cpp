#include "normals/evidence.hpp"

#include "core/vec3.hpp"
#include "exec/this_space.hpp"
#include "normals/arrays.hpp"
#include "octree/frame.hpp"

namespace pointskin::normals {
namespace {

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
    const Vec3d n = to_double(lines[i]);
    const Vec3d view = towards.empty() ? towards_nearest(i) : to_double(towards[order[i]]);
    const double along = dot(n, view);
    const double limit = kGrazing * kGrazing * dot(view, view);
    evidence[i] = along * along > limit ? (along > 0 ? 1 : -1) : 0;
  }
  [[nodiscard]] PSK_HD Vec3d towards_nearest(std::int64_t i) const {
    const Vec3f u = positions[i];
    const Vec3d p = {frame.lower[0] + static_cast<double>(u.x) * frame.size,
                     frame.lower[1] + static_cast<double>(u.y) * frame.size,
                     frame.lower[2] + static_cast<double>(u.z) * frame.size};
    Vec3d best{};
    double nearest = -1;
    for (std::int64_t s = 0; s < sensors.size; ++s) {
      const Vec3d v = sensors[s] - p;
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
    const Vec3d g = to_double(given[i]);
    const double along = dot(g, to_double(lines[i]));
    evidence[i] = along * along > kAcross * kAcross * dot(g, g) ? (along > 0 ? 1 : -1) : 0;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<std::int32_t> find_evidence(Exec& ex, const PreparedCloud& points, ArrayView<const Vec3f> lines,
                                         const Views& views, NormalMethod method) {
  if (method != NormalMethod::repair && method != NormalMethod::sensor) return {};
  const std::int64_t n = points.positions.size();
  auto evidence = exec::make_buffer<std::int32_t>(ex, n);
  if (method == NormalMethod::repair) {
    for_each(ex, "normals.given", n, GivenSide{points.given.cview(), lines, evidence.view()});
    return evidence;
  }
  const exec::Buffer<Vec3d> sensors = to_device(ex, views.sensors);
  const exec::Buffer<Vec3f> towards = to_device(ex, views.towards);
  for_each(ex, "normals.seen", n,
           SeenFrom{points.frame, points.positions.cview(), lines, points.order.cview(), sensors.cview(),
                    towards.cview(), evidence.view()});
  return evidence;
}

PSK_INSTANTIATE(find_evidence);

}  // namespace pointskin::normals
