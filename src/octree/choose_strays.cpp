#include "octree/strays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/box.hpp"
#include "core/stray_limit.hpp"
#include "octree/bounding_box.hpp"

namespace pointskin::octree {
namespace strays {
namespace {

Vec3d wide(const Vec3f& p) { return {p.x, p.y, p.z}; }

/// Of `p` from the box, along the axis where it is largest; 0 inside.
double distance(const Box& box, const Vec3d& p) {
  double largest = 0;
  for (std::size_t a = 0; a < 3; ++a) largest = std::max({largest, box.lower[a] - p[a], p[a] - box.upper[a]});
  return largest;
}

Box wide(const Bounds& box) { return {wide(box.lower), wide(box.upper)}; }

struct Place {
  Vec3d at;
  std::int32_t index;
};

std::vector<Place> places_of(const Candidates& candidates) {
  std::vector<Place> places;
  places.reserve(candidates.indices.size());
  for (std::size_t i = 0; i < candidates.indices.size(); ++i)
    places.push_back({wide(candidates.positions[i]), candidates.indices[i]});
  return places;
}

double largest_difference(const Vec3d& p, const Vec3d& q) {
  return std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
}

/// Moves the places for which `belongs` holds from `outside` into the core. All are asked before the core grows.
/// @returns false if there are none
template <class Belongs>
bool take_in(Box& core, std::vector<Place>& outside, const Belongs& belongs) {
  const auto first = std::stable_partition(outside.begin(), outside.end(), [&](const Place& p) { return !belongs(p); });
  if (first == outside.end()) return false;
  std::for_each(first, outside.end(), [&](const Place& p) { core.add(p.at, p.at); });
  outside.erase(first, outside.end());
  return true;
}

/// What lies within the core's longest side belongs to it.
bool take_in_near(Box& core, std::vector<Place>& outside) {
  const double reach = core.longest_side();
  return take_in(core, outside, [&](const Place& p) { return distance(core, p.at) <= reach; });
}

/// Of more than a few points, those belong to the cloud that are parts of something: that have company at other places
/// close by, measured by how far they are from the core.
bool take_in_parts(Box& core, std::vector<Place>& outside) {
  constexpr int kCompany = 8;
  constexpr double kClose = 1.0 / 8;
  if (static_cast<std::int64_t>(outside.size()) <= kFewPoints) return false;
  const std::vector<Place> all = outside;
  const Box before = core;
  return take_in(core, outside, [&](const Place& p) {
    const double close = kClose * distance(before, p.at);
    return kCompany <= std::count_if(all.begin(), all.end(), [&](const Place& q) {
             return q.at != p.at && largest_difference(p.at, q.at) <= close;
           });
  });
}

/// Bounding box of all points but the strays, of which there are no more than points beyond each end.
Bounds box_without(const std::vector<Place>& strays, const Candidates& candidates, const Bounds& ends) {
  std::vector<std::int32_t> left_out;
  for (const Place& stray : strays) left_out.push_back(stray.index);
  std::sort(left_out.begin(), left_out.end());
  Bounds box = ends;
  for (std::size_t i = 0; i < candidates.indices.size(); ++i) {
    if (std::binary_search(left_out.begin(), left_out.end(), candidates.indices[i])) continue;
    box = JoinBoxes{}(box, {candidates.positions[i], candidates.positions[i]});
  }
  return box;
}

/// @param sorted  so many of the farthest come first, in their order
StrayPoints farthest_first(std::vector<Place> strays, const Bounds& core, std::size_t sorted) {
  const Box box = wide(core);
  const auto end = strays.begin() + static_cast<std::ptrdiff_t>(std::min(sorted, strays.size()));
  std::partial_sort(strays.begin(), end, strays.end(), [&](const Place& p, const Place& q) {
    const auto key = [&](const Place& s) { return std::tuple(-distance(box, s.at), s.at.x, s.at.y, s.at.z, s.index); };
    return key(p) < key(q);
  });
  StrayPoints result;
  result.core = core;
  for (const Place& p : strays) {
    result.indices.push_back(p.index);
    result.positions.push_back({static_cast<float>(p.at[0]), static_cast<float>(p.at[1]), static_cast<float>(p.at[2])});
  }
  return result;
}

}  // namespace

bool may_have_strays(const Bounds& all, const Bounds& inner) {
  // A core without strays holds a point at or beyond either inner end, so it reaches at least this far. The factor is
  // for the rounding of a sum.
  const Box box = wide(inner);
  const double reach = 0.999 * std::max(0.0, box.longest_side());
  for (std::size_t a = 0; a < 3; ++a) {
    if (wide(all.lower)[a] < box.lower[a] - reach || wide(all.upper)[a] > box.upper[a] + reach) return true;
  }
  return false;
}

Bounds ends_of(const std::vector<Bounds>& boxes, std::int64_t rank) {
  const auto at_rank = [&](const auto& value_of) {
    std::vector<double> values(boxes.size());
    std::transform(boxes.begin(), boxes.end(), values.begin(), value_of);
    return static_cast<float>(smallest(std::move(values), rank, 0));
  };
  return {{at_rank([](const Bounds& b) { return b.lower.x; }), at_rank([](const Bounds& b) { return b.lower.y; }),
           at_rank([](const Bounds& b) { return b.lower.z; })},
          {-at_rank([](const Bounds& b) { return -b.upper.x; }), -at_rank([](const Bounds& b) { return -b.upper.y; }),
           -at_rank([](const Bounds& b) { return -b.upper.z; })}};
}

StrayPoints choose_strays(const Candidates& candidates, const Bounds& ends, const Bounds& all, std::int64_t limit) {
  constexpr double kWorthIt = 1.5;  // the box with strays / the box without
  const StrayPoints none{{}, {}, all};
  std::vector<Place> outside = places_of(candidates);
  // With the number of strays as the rank, every core must hold it.
  Box core = middle_of(
      outside, [](const Place& p) { return p.at; }, wide(ends), limit);
  if (!(core.longest_side() > 0)) return none;  // nearly all points are at one place: the others make the shape
  take_in(core, outside, [&](const Place& p) { return distance(core, p.at) == 0; });
  while (take_in_near(core, outside) || take_in_parts(core, outside)) {
  }
  if (outside.empty() || static_cast<std::int64_t>(outside.size()) > limit) return none;
  const Bounds without = box_without(outside, candidates, ends);
  if (wide(all).longest_side() < kWorthIt * wide(without).longest_side()) return none;
  const std::size_t all_of_them = outside.size();
  return farthest_first(std::move(outside), without, all_of_them);
}

StrayPoints as_strays(const Candidates& candidates, const Bounds& core) {
  return farthest_first(places_of(candidates), core, kMostReported);
}

}  // namespace strays

}  // namespace pointskin::octree
