#include "octree/strays.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/box.hpp"
#include "core/stray_limit.hpp"
#include "exec/this_space.hpp"
#include "octree/bounding_box.hpp"
#include "octree/extent.hpp"

namespace pointskin::octree {
namespace {

using namespace strays;

/// Box of the points that one lane of exec::reduce takes: those at equal distances in the caller's order.
struct BoxOfLane {
  ArrayView<const Vec3f> positions;
  std::int64_t lanes;
  ArrayView<Bounds> out;
  PSK_HD void operator()(std::int64_t lane) const {
    out[lane] = exec::combine_lane(BoxOf{positions}, JoinBoxes{}, positions.size, lanes, lane);
  }
};

struct ExtentOfLane {
  ArrayView<const Vec3f> positions;
  std::int64_t lanes;
  ArrayView<Extent> out;
  PSK_HD void operator()(std::int64_t lane) const {
    out[lane] = extent_of_lane(exec::combine_lane(BoxOf{positions}, JoinBoxes{}, positions.size, lanes, lane));
  }
};

/// True for points beyond the ends.
struct IsBeyond {
  ArrayView<const Vec3f> positions;
  Bounds ends;
  PSK_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return p.x < ends.lower.x || p.y < ends.lower.y || p.z < ends.lower.z || p.x > ends.upper.x || p.y > ends.upper.y ||
           p.z > ends.upper.z;
  }
};

/// The i-th index that is not in a list.
struct SkipListed {
  ArrayView<const std::int32_t> listed;  // ascending
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t i) const {
    std::int64_t first = 0;  // listed indices below the one that is looked for
    std::int64_t last = listed.size;
    while (first < last) {
      const std::int64_t middle = (first + last) / 2;
      if (listed[middle] - middle <= i)
        first = middle + 1;
      else
        last = middle;
    }
    out[i] = static_cast<std::int32_t>(i + first);
  }
};

template <exec::Space Exec>
Extent measure_extent(Exec& ex, ArrayView<const Vec3f> positions) {
  const std::int64_t lanes = exec::reduce_lanes(positions.size);
  auto extents = exec::make_buffer<Extent>(ex, lanes);
  for_each_long(ex, "octree.bounds", lanes, ExtentOfLane{positions, lanes, extents.view()});
  const auto joined = exec::reduce_lane_values(ex, "octree.bounds", std::move(extents), JoinExtents{});
  return exec::read_element(ex, joined.cview(), 0);
}

/// Ends beyond which lie few points, but all strays: of many lanes, `limit` and one more have points at or beyond them.
template <exec::Space Exec>
Bounds find_ends(Exec& ex, ArrayView<const Vec3f> positions, std::int64_t limit) {
  constexpr std::int64_t kLanes = 4096;
  const std::int64_t lanes = std::min(kLanes, exec::reduce_lanes(positions.size));
  auto boxes = exec::make_buffer<Bounds>(ex, lanes);
  for_each_long(ex, "octree.strays", lanes, BoxOfLane{positions, lanes, boxes.view()});
  return ends_of(exec::to_vector(ex, boxes), limit);
}

template <exec::Space Exec>
Candidates find_candidates(Exec& ex, ArrayView<const Vec3f> positions, const Bounds& ends) {
  const exec::Buffer<std::int32_t> found = select(ex, "octree.strays", positions.size, IsBeyond{positions, ends});
  auto places = exec::make_buffer<Vec3f>(ex, found.size());
  exec::gather(ex, positions, found.cview(), places.view());
  return {exec::to_vector(ex, found), exec::to_vector(ex, places)};
}

}  // namespace

template <exec::Space Exec>
StrayPoints find_strays(Exec& ex, ArrayView<const Vec3f> positions) {
  if (positions.empty()) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  return find_strays_in(ex, positions, measure_extent(ex, positions));
}

template <exec::Space Exec>
StrayPoints find_strays_in(Exec& ex, ArrayView<const Vec3f> positions, const Extent& extent) {
  const std::int64_t limit = stray_limit(positions.size);
  const bool countable = positions.size <= std::numeric_limits<std::int32_t>::max();
  if (limit == 0 || !countable || !may_have_strays(extent.all, extent.inner)) return {{}, {}, extent.all};
  const Bounds ends = find_ends(ex, positions, limit);
  return choose_strays(find_candidates(ex, positions, ends), ends, extent.all, limit);
}

template <exec::Space Exec>
StrayPoints find_outside(Exec& ex, ArrayView<const Vec3f> positions, const Frame& cube, const Bounds& core) {
  const Bounds ends{cube.to_world({0, 0, 0}), cube.to_world({1, 1, 1})};
  return as_strays(find_candidates(ex, positions, ends), core);
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> without_strays(Exec& ex, std::int64_t n, const StrayPoints& strays) {
  if (strays.indices.empty()) return {};
  std::vector<std::int32_t> ascending = strays.indices;
  std::sort(ascending.begin(), ascending.end());
  auto listed = exec::make_buffer<std::int32_t>(ex, strays.size());
  copy_to_device(ex, ascending.data(), listed.view());
  auto others = exec::make_buffer<std::int32_t>(ex, n - strays.size());
  for_each(ex, "octree.strays", others.size(), SkipListed{listed.cview(), others.view()});
  return others;
}

PSK_INSTANTIATE(find_strays);
PSK_INSTANTIATE(find_strays_in);
PSK_INSTANTIATE(find_outside);
PSK_INSTANTIATE(without_strays);

}  // namespace pointskin::octree
