#include "scale/cloud_extent.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/stray_limit.hpp"
#include "exec/cpu_primitives.hpp"
#include "exec/reduce_order.hpp"
#include "octree/bounding_box.hpp"
#include "octree/extent.hpp"

namespace pointskin::scale {
namespace {

using octree::JoinBoxes;

/// The box of every `lanes`-th point, as in memory. Neighbours in a file are often neighbours in space: their boxes
/// would say little of the whole. Points are those of this rank, from 0 on.
class LaneBoxes {
 public:
  explicit LaneBoxes(std::int64_t rows) {
    constexpr std::int64_t kMostLanes = 4096;
    boxes_.resize(static_cast<std::size_t>(std::min(kMostLanes, exec::reduce_lanes(rows))));
  }

  void add(exec::Cpu& ex, const std::vector<Vec3f>& positions) {
    const auto lanes = static_cast<std::int64_t>(boxes_.size());
    const auto count = static_cast<std::int64_t>(positions.size());
    for_each_long(ex, "scale.extent", lanes, [&, this](std::int64_t lane) {
      Bounds& box = boxes_[static_cast<std::size_t>(lane)];
      const std::int64_t before = points_ / lanes + (lane < points_ % lanes ? 1 : 0);  // points of the lane so far
      for (std::int64_t i = before * lanes + lane - points_; i < count; i += lanes) {
        const Vec3f& p = positions[static_cast<std::size_t>(i)];
        box = i + points_ < lanes ? Bounds{p, p} : JoinBoxes{}(box, {p, p});
      }
    });
    points_ += count;
  }

  [[nodiscard]] std::int64_t points() const { return points_; }
  /// Of the lanes that have points of any rank; there must be some. Collective.
  [[nodiscard]] std::vector<Bounds> boxes(const Team& team) const {
    const std::vector<std::vector<Bounds>> of_ranks = team.gather(own_boxes());
    const std::vector<std::int64_t> points = team.gather_all(std::vector<std::int64_t>{points_});
    std::vector<Bounds> all;
    std::int64_t before = 0;
    for (std::size_t rank = 0; rank < of_ranks.size(); before += points[rank++])
      for (std::size_t i = 0; i < of_ranks[rank].size(); ++i) {
        const std::size_t lane = (static_cast<std::size_t>(before) + i) % boxes_.size();
        if (lane < all.size())
          all[lane] = JoinBoxes{}(all[lane], of_ranks[rank][i]);
        else
          all.push_back(of_ranks[rank][i]);
      }
    return all;
  }

 private:
  [[nodiscard]] std::vector<Bounds> own_boxes() const {
    return {boxes_.begin(), boxes_.begin() + std::min<std::ptrdiff_t>(std::ssize(boxes_), points_)};
  }

  std::vector<Bounds> boxes_;
  std::int64_t points_ = 0;
};

octree::Extent joined(const std::vector<Bounds>& boxes) {
  octree::Extent all = octree::extent_of_lane(boxes.front());
  for (const Bounds& box : boxes) all = octree::JoinExtents{}(all, octree::extent_of_lane(box));
  return all;
}

bool is_zero(const Vec3f& n) { return n.x == 0 && n.y == 0 && n.z == 0; }

std::int64_t count_normals(const std::vector<Vec3f>& normals) {
  return std::ssize(normals) - std::count_if(normals.begin(), normals.end(), is_zero);
}

bool is_beyond(const Vec3f& p, const Bounds& ends) {
  return p.x < ends.lower.x || p.y < ends.lower.y || p.z < ends.lower.z || p.x > ends.upper.x || p.y > ends.upper.y ||
         p.z > ends.upper.z;
}

/// Points that may be strays, and of which of them the normal is not zero.
struct CandidatesWithNormals {
  octree::strays::Candidates candidates;
  std::vector<std::int32_t> with_normal;  ///< indices, ascending
};

/// @param before  points in the rows before this rank's
CandidatesWithNormals find_candidates(exec::Cpu& ex, const io::CloudParts& parts, const Bounds& ends, const Team& team,
                                      std::int64_t before) {
  CandidatesWithNormals found;
  auto first = static_cast<std::int32_t>(before);
  const Team::Share rows = team.share_of(parts.rows());
  parts.for_parts(ex, rows.begin, rows.end, [&](const Cloud& cloud) {
    const auto positions = ArrayView<const Vec3f>{cloud.positions.data(), cloud.size()};
    const exec::Buffer<std::int32_t> beyond =
        select(ex, "scale.strays", positions.size, [&](std::int64_t i) { return is_beyond(positions[i], ends); });
    for (std::int64_t k = 0; k < beyond.size(); ++k) {
      const std::int32_t i = beyond.data()[k];
      found.candidates.indices.push_back(first + i);
      found.candidates.positions.push_back(positions[i]);
      if (cloud.has_normals() && !is_zero(cloud.normals[static_cast<std::size_t>(i)]))
        found.with_normal.push_back(first + i);
    }
    first += static_cast<std::int32_t>(cloud.size());
  });
  found.candidates.indices = team.gather_all(std::move(found.candidates.indices));
  found.candidates.positions = team.gather_all(std::move(found.candidates.positions));
  found.with_normal = team.gather_all(std::move(found.with_normal));
  return found;
}

}  // namespace

CloudExtent find_extent(exec::Cpu& ex, const io::CloudParts& parts, bool keep_strays, const Team& team) {
  LaneBoxes lanes(parts.rows());
  CloudExtent found;
  const Team::Share rows = team.share_of(parts.rows());
  parts.for_parts(ex, rows.begin, rows.end, [&](const Cloud& cloud) {
    lanes.add(ex, cloud.positions);
    found.with_normal += count_normals(cloud.normals);
    found.dropped += cloud.dropped;
  });
  found.with_normal = team.reduce(found.with_normal, std::plus<>{});
  found.dropped = team.reduce(found.dropped, std::plus<>{});
  const std::vector<std::int64_t> points = team.gather_all(std::vector<std::int64_t>{lanes.points()});
  found.points = std::accumulate(points.begin(), points.end(), std::int64_t{0});
  found.before = std::accumulate(points.begin(), points.begin() + team.rank(), std::int64_t{0});
  if (found.points == 0) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  const std::vector<Bounds> boxes = lanes.boxes(team);
  const octree::Extent extent = joined(boxes);
  found.strays.core = extent.all;
  const std::int64_t limit = stray_limit(found.points);
  const bool countable = found.points <= std::numeric_limits<std::int32_t>::max();
  if (keep_strays || limit == 0 || !countable || !octree::strays::may_have_strays(extent.all, extent.inner))
    return found;
  const Bounds ends = octree::strays::ends_of(boxes, limit);
  const CandidatesWithNormals beyond = find_candidates(ex, parts, ends, team, found.before);
  found.strays = octree::strays::choose_strays(beyond.candidates, ends, extent.all, limit);
  found.points -= found.strays.size();
  for (const std::int32_t i : found.strays.indices)
    if (std::binary_search(beyond.with_normal.begin(), beyond.with_normal.end(), i)) --found.with_normal;
  return found;
}

octree::StrayPoints find_outside(exec::Cpu& ex, const io::CloudParts& parts, const octree::Frame& cube,
                                 const Bounds& core, const Team& team, std::int64_t before) {
  const Bounds ends{cube.to_world({0, 0, 0}), cube.to_world({1, 1, 1})};
  return octree::strays::as_strays(find_candidates(ex, parts, ends, team, before).candidates, core);
}

}  // namespace pointskin::scale
