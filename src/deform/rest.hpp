// The cloud at rest as deformations need it: in Morton order, with its surface and the distances of its samples.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/mix_bits.hpp"
#include "deform/resample.hpp"
#include "exec/algorithms.hpp"
#include "octree/search.hpp"
#include "reconstruct/fit_field.hpp"

namespace pointskin::detail {

/// The rest cloud. Arrays of shape (n) are in Morton order, ties by the bits of position and normal.
struct RestCloud {
  Vec3d origin{};
  exec::Buffer<Vec3f> caller_positions;     ///< in the caller's order, for lists of points
  exec::Buffer<Vec3f> positions, normals;   ///< (n)
  exec::Buffer<Vec3f> unit;                 ///< (n) positions in the cube of the field
  exec::Buffer<float> spacings;             ///< (n) as RestSamples
  std::vector<AttributeBuffer> attributes;  ///< (n) each, under the caller's names
  std::vector<std::string> mesh_names;      ///< the attributes' names on meshes
  FieldData field;

  [[nodiscard]] std::int64_t size() const { return positions.size(); }
  [[nodiscard]] deform::RestSamples samples() const { return {positions.cview(), normals.cview(), spacings.cview()}; }
  [[nodiscard]] deform::RestSurface surface() const { return {field.view(DomainFaces::closed), field.frame}; }
};

namespace rest {

/// A function of all bits of a point.
struct HashPoint {
  ArrayView<const Vec3f> positions, normals;
  octree::Selection selection;
  ArrayView<std::uint64_t> hashes;

  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t from = selection(i);
    hashes[i] = mix_vector(mix_vector(kHashSeed, positions[from]), normals[from]);
  }
};
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
octree::SortedPoints sort(Exec& ex, const PointBuffers& points, const octree::Frame& frame) {
  const std::int64_t n = points.used_count();
  const octree::Selection selection{points.used.cview()};
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  auto hashes = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "deform.rest", n, octree::ToUnit{frame, points.positions.cview(), unit.view(), selection});
  for_each(ex, "deform.rest", n, HashPoint{points.positions.cview(), points.normals.cview(), selection, hashes.view()});
  for (const AttributeBuffer& attribute : points.attributes)
    for_each(ex, "deform.rest", n, HashValue{attribute.values.view(), selection, hashes.view()});
  octree::SortedPoints sorted = octree::sort_points(ex, unit.cview(), hashes.cview());
  if (!points.used.empty()) exec::gather(ex, points.used.cview(), sorted.order.cview(), sorted.order.view());
  return sorted;
}

template <class T, exec::Space Exec>
exec::Buffer<T> gathered(Exec& ex, const exec::Buffer<T>& from, const exec::Buffer<std::int32_t>& index) {
  auto to = exec::make_buffer<T>(ex, index.size());
  exec::gather(ex, from.cview(), index.cview(), to.view());
  return to;
}

}  // namespace rest

/// Makes a cloud ready that is on the device. Leaves strays out as `options` say.
template <exec::Space Exec>
RestCloud make_rest(Exec& ex, PointBuffers points, const Vec3d& origin, const Options& options, RunReport& report) {
  RestCloud out;
  out.origin = origin;
  std::vector<AttributeBuffer> attributes = std::move(points.attributes);
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

  const octree::SortedPoints sorted = rest::sort(ex, points, out.field.frame);
  out.positions = rest::gathered(ex, points.positions, sorted.order);
  out.normals = rest::gathered(ex, points.normals, sorted.order);
  for (const AttributeBuffer& attribute : points.attributes)
    out.attributes.push_back({attribute.name, exec::gather_typed(ex, attribute.values.view(), sorted.order.cview())});
  out.caller_positions = std::move(points.positions);
  const std::int64_t n = out.size();
  out.unit = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "deform.rest", n, octree::ToUnit{out.field.frame, out.positions.cview(), out.unit.view()});
  out.spacings = exec::make_buffer<float>(ex, n);
  poisson::evaluate_density(ex, out.field.tree, out.field.density, out.unit.cview(), out.spacings.view());
  const double cell_world = out.field.frame.size / static_cast<double>(std::int64_t{1} << out.field.tree.depth);
  for_each(ex, "deform.rest", n, rest::SpacingOf{out.spacings.view(), static_cast<float>(cell_world)});
  out.field.density.counts.reset();
  return out;
}

}  // namespace pointskin::detail
