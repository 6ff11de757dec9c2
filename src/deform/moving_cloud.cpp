#include "deform/moving_cloud.hpp"

#include <pointskin/error.hpp>

#include <cstdint>
#include <string>
#include <utility>

#include "core/announce.hpp"
#include "core/stopwatch.hpp"
#include "deform/arrays.hpp"
#include "deform/deform_map.hpp"
#include "deform/prepare_deformation.hpp"
#include "deform/spacing.hpp"
#include "exec/this_space.hpp"
#include "exec/typed_buffer.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::deform {
namespace {

using detail::PhaseClock;
using detail::PointBuffers;

template <class T, exec::Space Exec>
void copy_out(Exec& ex, const exec::Buffer<T>& from, std::vector<T>& to) {
  to.resize(static_cast<std::size_t>(from.size()));
  copy_to_host(ex, from.cview(), to.data());
}

/// Of the samples as they are now.
template <exec::Space Exec>
exec::TypedBuffer attribute_of(Exec& ex, const MovingCloud& moving, std::size_t a) {
  return exec::gather_typed(ex, moving.rest.attributes[a].values.view(), moving.samples.parents.cview());
}

/// The identity: copies.
template <exec::Space Exec>
void stay(Exec& ex, MovingCloud& moving, DeformReport& report) {
  PhaseClock clock(ex);
  const RestCloud& rest = moving.rest;
  Resampled& samples = moving.samples;
  samples = {};
  samples.positions = exec::make_buffer<Vec3f>(ex, rest.size());
  samples.normals = exec::make_buffer<Vec3f>(ex, rest.size());
  copy(ex, rest.positions.cview(), samples.positions.view());
  copy(ex, rest.normals.cview(), samples.normals.view());
  samples.parents = exec::iota(ex, rest.size());
  clock.lap(report.sample_ms);
  clock.read();
  report.map_ms = 0;
}

template <exec::Space Exec>
void resample_and_map(Exec& ex, const PreparedDeformation& prepared, MovingCloud& moving, DeformReport& report) {
  PhaseClock clock(ex);
  const RestCloud& rest = moving.rest;
  const exec::Buffer<HandleData> handles = on_device(ex, prepared.handles);
  const exec::Buffer<LatticeData> lattices = on_device(ex, prepared.lattices);
  const exec::Buffer<Vec3d> moves = on_device(ex, prepared.moves);
  choose_points(ex, rest, prepared.point_sets, moving.chosen);
  MapView map{handles.cview(), lattices.cview(), moves.cview(), {}, 0};

  exec::Buffer<Vec3f> nearest = nearest_at_rest(ex, rest, prepared.point_sets, moving.chosen);
  map.nearest = nearest.cview();
  map.nearest_stride = rest.size();
  Resampled samples = resample(ex, map, rest.samples(), rest.surface());
  clock.lap(report.sample_ms);
  if (!prepared.point_sets.empty()) {
    nearest = nearest_to(ex, rest, prepared.point_sets, moving.chosen, samples.positions.cview());
    map.nearest = nearest.cview();
    map.nearest_stride = samples.positions.size();
  }
  map_samples(ex, map, samples.positions.view(), samples.normals.view());
  moving.samples = std::move(samples);
  clock.lap(report.map_ms);
  clock.read();
}

/// Of the samples as they are now, with their names.
template <exec::Space Exec>
std::vector<detail::AttributeBuffer> mesh_attributes(Exec& ex, const MovingCloud& moving) {
  std::vector<detail::AttributeBuffer> attributes;
  if (moving.options.attributes)
    for (std::size_t a = 0; a < moving.rest.attributes.size(); ++a)
      attributes.push_back({moving.rest.attributes[a].name, attribute_of(ex, moving, a)});
  return attributes;
}

}  // namespace

template <exec::Space Exec>
MovingCloud start(Exec& ex, const Cloud& cloud, const Options& options, DeformReport& report) {
  Stopwatch watch;
  MovingCloud moving;
  moving.options = options;
  moving.options.keep_strays = true;  // they are left out already
  moving.envelope = detail::make_envelope(ex, options, cloud.origin);
  PointBuffers points = detail::upload(ex, cloud);
  points.attributes = detail::upload_attributes(ex, cloud);
  ex.synchronize();
  report.upload_ms = watch.lap();
  moving.rest = make_rest(ex, std::move(points), cloud.origin, options, report.run);
  for (Vec3d& p : report.run.farthest_strays)
    for (std::size_t a = 0; a < 3; ++a) p[a] += cloud.origin[a];
  ex.synchronize();
  report.rest_ms = watch.lap();
  report.rest_points = moving.rest.size();
  deform::apply(ex, {}, moving, report);
  return moving;
}

template <exec::Space Exec>
void apply(Exec& ex, const Deformation& deformation, MovingCloud& moving, DeformReport& report) {
  const PreparedDeformation prepared = prepare(deformation, moving.rest.origin);
  if (prepared.identity)
    stay(ex, moving, report);
  else
    resample_and_map(ex, prepared, moving, report);
  report.points = moving.samples.positions.size();
  report.inserted = moving.samples.inserted;
  report.thinned = moving.samples.thinned;
}

template <exec::Space Exec>
void reconstruct(Exec& ex, MovingCloud& moving, Mesh& mesh, DeformReport& report) {
  Stopwatch watch;
  ex.pool()->reset_peak();
  const std::int64_t strays = report.run.strays;
  std::vector<Vec3d> farthest = std::move(report.run.farthest_strays);
  report.run = {};
  Resampled& samples = moving.samples;
  PointBuffers points{std::move(samples.positions), std::move(samples.normals)};
  const auto put_back = [&] {
    samples.positions = std::move(points.positions);
    samples.normals = std::move(points.normals);
  };
  try {
    const Options& options = moving.options;
    points.attributes = mesh_attributes(ex, moving);
    detail::FieldData field =
        fit_field(ex, points, {.keep_points = true, .envelope = moving.envelope}, options, report.run);
    put_back();
    announce(options.progress, "extract", 0.8);
    extract_and_release(ex, field, options, moving.rest.origin, mesh, report.run);
  } catch (...) {
    if (samples.positions.empty()) put_back();
    throw;
  }
  report.run.strays = strays;
  report.run.farthest_strays = std::move(farthest);
  report.mesh_ms = watch.lap();
}

template <exec::Space Exec>
Cloud copy_cloud(Exec& ex, const MovingCloud& moving) {
  Cloud out;
  out.origin = moving.rest.origin;
  copy_out(ex, moving.samples.positions, out.positions);
  copy_out(ex, moving.samples.normals, out.normals);
  for (std::size_t a = 0; a < moving.rest.attributes.size(); ++a)
    out.attributes.push_back({moving.rest.attributes[a].name, exec::download_typed(ex, attribute_of(ex, moving, a))});
  return out;
}

template <exec::Space Exec>
SpacingRatios measure_spacing(Exec& ex, MovingCloud& moving) {
  const exec::Buffer<Vec3f>& positions = moving.samples.positions;
  if (moving.rest.size() < 2 || positions.size() < 2) return {};
  if (moving.rest_distances.empty()) moving.rest_distances = neighbour_distances(ex, moving.rest.positions.cview());
  const std::vector<float> now = neighbour_distances(ex, positions.cview());
  std::vector<std::int32_t> parents;
  copy_out(ex, moving.samples.parents, parents);
  return spacing_ratios(now, moving.rest_distances, parents);
}

PSK_INSTANTIATE(start);
PSK_INSTANTIATE(apply);
PSK_INSTANTIATE(reconstruct);
PSK_INSTANTIATE(copy_cloud);
PSK_INSTANTIATE(measure_spacing);

}  // namespace pointskin::deform
