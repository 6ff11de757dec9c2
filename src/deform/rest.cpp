#include "deform/rest.hpp"

#include <cmath>
#include <utility>

#include "deform/arrays.hpp"
#include "exec/this_space.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "reconstruct/point_hash.hpp"

namespace pointskin::deform {
namespace {

struct HashValue {
  TypedView values;
  octree::Selection selection;
  ArrayView<std::uint64_t> hashes;
  PSK_HD void operator()(std::int64_t i) const { hashes[i] = values.mixed_into(hashes[i], selection(i)); }
};

/// Samples a finest cell face to the side of a sample's square.
struct SpacingOf {
  ArrayView<float> values;
  float cell_world;
  PSK_HD void operator()(std::int64_t i) const {
    values[i] = values[i] > 0 ? cell_world / std::sqrt(values[i]) : cell_world;
  }
};

/// Order of the used points in the cube of the field; the result leads to the caller's points.
template <exec::Space Exec>
octree::SortedPoints sort(Exec& ex, const detail::PointBuffers& points, const octree::Frame& frame) {
  const std::int64_t n = points.used_count();
  const octree::Selection selection{points.used.cview()};
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  auto hashes = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "deform.rest", n, octree::ToUnit{frame, points.positions.cview(), unit.view(), selection});
  for_each(ex, "deform.rest", n,
           detail::HashPoint{points.positions.cview(), points.normals.cview(), hashes.view(), selection});
  for (const detail::AttributeBuffer& attribute : points.attributes)
    for_each(ex, "deform.rest", n, HashValue{attribute.values.view(), selection, hashes.view()});
  octree::SortedPoints sorted = octree::sort_points(ex, unit.cview(), hashes.cview());
  if (!points.used.empty()) exec::gather(ex, points.used.cview(), sorted.order.cview(), sorted.order.view());
  return sorted;
}

}  // namespace

template <exec::Space Exec>
RestCloud make_rest(Exec& ex, detail::PointBuffers points, const Vec3d& origin, const Options& options,
                    RunReport& report) {
  RestCloud out;
  out.origin = origin;
  std::vector<detail::AttributeBuffer> attributes = std::move(points.attributes);
  points.attributes.clear();
  Options fit = options;
  fit.density = true;  // keeps the counts
  fit.attributes = false;
  fit.offset = 0;
  fit.trim = 0;
  fit.weakness = false;
  fit.residuals = false;
  out.field = fit_field(ex, points, {.keep_points = true}, fit, report);
  points.attributes = std::move(attributes);

  const octree::SortedPoints sorted = sort(ex, points, out.field.frame);
  out.positions = gathered(ex, points.positions, sorted.order);
  out.normals = gathered(ex, points.normals, sorted.order);
  for (const detail::AttributeBuffer& attribute : points.attributes)
    out.attributes.push_back({attribute.name, exec::gather_typed(ex, attribute.values.view(), sorted.order.cview())});
  out.caller_positions = std::move(points.positions);
  const std::int64_t n = out.size();
  out.unit = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "deform.rest", n, octree::ToUnit{out.field.frame, out.positions.cview(), out.unit.view()});
  out.spacings = exec::make_buffer<float>(ex, n);
  poisson::evaluate_density(ex, out.field.tree, out.field.density, out.unit.cview(), out.spacings.view());
  const double cell_world = out.field.frame.size / static_cast<double>(std::int64_t{1} << out.field.tree.depth);
  for_each(ex, "deform.rest", n, SpacingOf{out.spacings.view(), static_cast<float>(cell_world)});
  out.field.density.counts.reset();
  return out;
}

PSK_INSTANTIATE(make_rest);

}  // namespace pointskin::deform
