#include "deform/chosen_points.hpp"

#include <algorithm>
#include <utility>

#include "deform/arrays.hpp"
#include "exec/this_space.hpp"
#include "octree/frame.hpp"
#include "octree/search.hpp"
#include "reconstruct/point_hash.hpp"

namespace pointskin::deform {
namespace {

template <exec::Space Exec>
exec::Buffer<Vec3f> to_unit(Exec& ex, const octree::Frame& frame, ArrayView<const Vec3f> positions) {
  auto unit = exec::make_buffer<Vec3f>(ex, positions.size);
  for_each(ex, "deform.choose", positions.size, octree::ToUnit{frame, positions, unit.view()});
  return unit;
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> search(Exec& ex, const ChosenPoints& chosen, const exec::Buffer<Vec3f>& queries) {
  auto ids = exec::make_buffer<std::int32_t>(ex, queries.size());
  auto squared = exec::make_buffer<float>(ex, queries.size());
  octree::find_nearest(ex, {chosen.tree.view(), chosen.sorted_unit.cview(), chosen.order.cview()}, queries.cview(), 1,
                       ids.view(), squared.view());
  return ids;
}

template <exec::Space Exec>
ChosenPoints choose(Exec& ex, const RestCloud& rest, const std::vector<std::int64_t>& points) {
  ChosenPoints out;
  out.points = points;
  out.positions =
      gathered(ex, rest.caller_positions, on_device(ex, std::vector<std::int32_t>(points.begin(), points.end())));
  const std::int64_t n = out.positions.size();
  const exec::Buffer<Vec3f> unit = to_unit(ex, rest.field.frame, out.positions.cview());
  auto ties = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "deform.choose", n, detail::HashPoint{out.positions.cview(), out.positions.cview(), ties.view()});
  octree::SortedPoints sorted = octree::sort_points(ex, unit.cview(), ties.cview());
  out.tree = octree::build_octree(ex, sorted.keys.cview(), rest.field.tree.depth);
  out.sorted_unit = gathered(ex, unit, sorted.order);
  out.order = std::move(sorted.order);
  out.nearest_at_rest = search(ex, out, rest.unit);
  return out;
}

/// The nearest points of every list, one row each.
/// @param ids_of  of a list that is ready: (n) index of the nearest in its positions
template <exec::Space Exec, class Ids>
exec::Buffer<Vec3f> rows(Exec& ex, const PointLists& lists, const std::vector<ChosenPoints>& chosen, std::int64_t n,
                         const Ids& ids_of) {
  const auto count = static_cast<std::int64_t>(lists.size());
  auto out = exec::make_buffer<Vec3f>(ex, count * n);
  for (std::int64_t r = 0; r < count; ++r) {
    const ChosenPoints& c = *std::find_if(chosen.begin(), chosen.end(), [&](const ChosenPoints& ready) {
      return ready.points == lists[static_cast<std::size_t>(r)];
    });
    exec::gather<Vec3f>(ex, c.positions.cview(), ids_of(c), out.view().part(r * n, n));
  }
  return out;
}

}  // namespace

template <exec::Space Exec>
void choose_points(Exec& ex, const RestCloud& rest, const PointLists& lists, std::vector<ChosenPoints>& chosen) {
  for (ChosenPoints& c : chosen) c.in_use = false;
  for (const std::vector<std::int64_t>& points : lists) {
    auto known = std::find_if(chosen.begin(), chosen.end(), [&](const ChosenPoints& c) { return c.points == points; });
    if (known == chosen.end()) known = chosen.insert(chosen.end(), choose(ex, rest, points));
    known->in_use = true;
  }
  std::erase_if(chosen, [](const ChosenPoints& c) { return !c.in_use; });
}

template <exec::Space Exec>
exec::Buffer<Vec3f> nearest_at_rest(Exec& ex, const RestCloud& rest, const PointLists& lists,
                                    const std::vector<ChosenPoints>& chosen) {
  return rows(ex, lists, chosen, rest.size(), [](const ChosenPoints& c) { return c.nearest_at_rest.cview(); });
}

template <exec::Space Exec>
exec::Buffer<Vec3f> nearest_to(Exec& ex, const RestCloud& rest, const PointLists& lists,
                               const std::vector<ChosenPoints>& chosen, ArrayView<const Vec3f> positions) {
  const exec::Buffer<Vec3f> unit = to_unit(ex, rest.field.frame, positions);
  exec::Buffer<std::int32_t> ids;
  return rows(ex, lists, chosen, positions.size, [&](const ChosenPoints& c) {
    ids = search(ex, c, unit);
    return ids.cview();
  });
}

PSK_INSTANTIATE(choose_points);
PSK_INSTANTIATE(nearest_at_rest);
PSK_INSTANTIATE(nearest_to);

}  // namespace pointskin::deform
