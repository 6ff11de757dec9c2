#include "surface/trim.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "exec/this_space.hpp"
#include "surface/check_size.hpp"
#include "surface/split_surface.hpp"
#include "surface/trim_pieces.hpp"

namespace pointskin::surface {
namespace {

using namespace trim;

}  // namespace

template <exec::Space Exec>
Surface trim_surface(Exec& ex, Surface surface, ArrayView<const float> values, const TrimOptions& options,
                     TrimCounts& counts) {
  const std::int64_t triangles = surface.triangles.size();
  if (triangles == 0) return surface;
  auto kept = exec::make_buffer<std::uint8_t>(ex, surface.positions.size());
  for_each(ex, "trim.sides", kept.size(), IsKept{values, options.limit, kept.view()});
  const SidesView mesh{surface.positions.cview(), surface.triangles.cview(), values, options.limit, kept.cview()};
  const auto measure = [&] {
    return exec::reduce<Extent>(ex, "trim.measure", triangles, ExtentOf{mesh}, AddExtents{});
  };
  Extent extent = measure();
  const auto least = area_units(options.island_ratio * extent.area.value(kAreaFraction));
  if (least > 0) {
    const SmallPieces small = clear_small_pieces(ex, mesh, least, kept.view());
    counts.islands_removed = small.kept;
    counts.holes_filled = small.cut;
    if (small.kept > 0 || small.cut > 0) extent = measure();
  }
  counts.area_before = extent.area.value(kAreaFraction);
  counts.area_kept = extent.kept_area.value(kAreaFraction);
  counts.triangles_before = triangles;
  counts.triangles_removed = triangles - extent.whole - extent.split;
  counts.triangles_split = extent.split;
  if (extent.whole == triangles) return surface;
  if (extent.whole + extent.split == 0) return {};
  // Vertices have room: there are fewer of them than triangles, but for borders, and fewer new ones than split
  // triangles.
  check_size("triangles", extent.whole + 2 * extent.split);
  return split_surface(ex, std::move(surface), mesh);
}

PSK_INSTANTIATE(trim_surface);

}  // namespace pointskin::surface
