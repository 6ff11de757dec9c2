#include "edit/states.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <variant>
#include <vector>

#include "core/stopwatch.hpp"
#include "edit/point_kind.hpp"
#include "edit/points.hpp"
#include "exec/this_space.hpp"
#include "exec/typed_buffer.hpp"
#include "octree/frame.hpp"
#include "poisson/mean_length.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::edit {
namespace {

using detail::FitSetup;
using detail::PointBuffers;

template <class T, exec::Space Exec>
void copy_out(Exec& ex, const exec::Buffer<T>& from, std::vector<T>& to) {
  to.resize(static_cast<std::size_t>(from.size()));
  copy_to_host(ex, from.cview(), to.data());
}

template <class T, exec::Space Exec>
exec::Buffer<T> copy_of(Exec& ex, const exec::Buffer<T>& from) {
  auto to = exec::make_buffer<T>(ex, from.size());
  copy(ex, from.cview(), to.view());
  return to;
}

template <exec::Space Exec>
exec::Buffer<std::uint8_t> all_original(Exec& ex, std::int64_t size) {
  auto buffer = exec::make_buffer<std::uint8_t>(ex, size);
  exec::fill(ex, buffer.view(), kOriginal);
  return buffer;
}

template <exec::Space Exec>
void extract(Exec& ex, const Settings& settings, State& state) {
  RunReport unused;
  state.surface = extract_some(ex, state.field, settings.options.reconstruction, unused);
}

template <exec::Space Exec>
std::shared_ptr<State> make_base(Exec& ex, const Settings& settings, const Cloud& base) {
  const Options& options = settings.options.reconstruction;
  auto state = std::make_shared<State>();
  PointBuffers points = detail::upload(ex, base);
  if (options.attributes) points.attributes = detail::upload_attributes(ex, base);
  RunReport unused;
  state->field = fit_field(ex, points, {.keep_points = true, .envelope = settings.envelope, .keep_samples = true},
                           options, unused);
  state->points = copy_used(ex, points);  // strays are gone for good
  state->points.added = all_original(ex, state->points.positions.size());
  state->field.samples.added = all_original(ex, state->field.samples.positions.size());
  return state;
}

const char* name_of(const Operation& operation) {
  constexpr const char* kNames[] = {"guide", "remove", "insert"};
  static_assert(std::size(kNames) == std::variant_size_v<Operation>);
  return kNames[operation.index()];
}

/// The cube before if all points are well inside of it, else one around them.
template <exec::Space Exec>
octree::Frame cube_for(Exec& ex, const octree::Frame& before, const PointBuffers& points, double scale) {
  const Bounds box = octree::box_around(ex, points.positions.cview());
  const auto margin = static_cast<float>((1 - 1 / scale) / 4);  // half of what is left around a cube of its own
  const Vec3f lower = before.to_unit(box.lower);
  const Vec3f upper = before.to_unit(box.upper);
  const bool inside = lower.x >= margin && lower.y >= margin && lower.z >= margin && upper.x <= 1 - margin &&
                      upper.y <= 1 - margin && upper.z <= 1 - margin;
  return inside ? before : octree::frame_around(box, scale);
}

/// Fits the field of a state whose points are there. @returns whether it started from the field before
template <exec::Space Exec>
bool fit(Exec& ex, const Settings& settings, const State& before, bool may_leave_cube, State& state) {
  const Options& options = settings.options.reconstruction;
  FitSetup setup{.keep_points = true, .cube = before.field.frame, .envelope = settings.envelope, .keep_samples = true};
  if (may_leave_cube) setup.cube = cube_for(ex, before.field.frame, state.points, options.scale);
  const bool solves = options.field == FieldKind::poisson;
  const bool warm = solves && settings.options.warm_start && *setup.cube == before.field.frame;
  if (warm) setup.before = &before.field;
  RunReport unused;
  state.field = fit_field(ex, state.points, setup, options, unused);
  return warm;
}

/// Milliseconds of the host since the last lap, the space's work being done.
template <exec::Space Exec>
double lap(Exec& ex, Stopwatch& watch) {
  ex.synchronize();
  return watch.lap();
}

}  // namespace

template <exec::Space Exec>
Beginning begin_session(Exec& ex, const Cloud& base, const EditOptions& options) {
  Settings settings{options, base.origin, {}, {}, 1};
  Options& reconstruction = settings.options.reconstruction;
  reconstruction.residuals = false;  // nobody sees them, and they cost more than the solve
  settings.envelope = detail::make_envelope(ex, reconstruction, base.origin);
  std::shared_ptr<State> state = make_base(ex, settings, base);
  settings.base_box = octree::box_around(ex, state->points.positions.cview());
  if (reconstruction.confidence) settings.normal_length = poisson::mean_length(ex, state->points.normals.cview());
  extract(ex, settings, *state);
  return {std::move(settings), std::move(state)};
}

template <exec::Space Exec>
SharedState make_next(Exec& ex, const Settings& settings, const SharedState& before, const Operation& operation,
                      StepReport& report) {
  Stopwatch watch;
  EditedPoints edited = edit_points(ex,
                                    {before->points, before->field, settings.origin, settings.base_box,
                                     settings.normal_length, settings.options.reconstruction},
                                    operation);
  report.edit_ms = lap(ex, watch);
  SharedState next = before;
  if (edited.changed()) {
    auto state = std::make_shared<State>();
    state->points = std::move(edited.points);
    report.warm = fit(ex, settings, *before, std::holds_alternative<Insert>(operation), *state);
    extract(ex, settings, *state);
    next = std::move(state);
  }
  report.reconstruct_ms = lap(ex, watch);
  report.operation = name_of(operation);
  report.added = edited.added;
  report.removed = edited.removed;
  report.snapped = edited.snapped;
  report.points = next->points.positions.size();
  return next;
}

template <exec::Space Exec>
void show(Exec& ex, const Settings& settings, const State& state, Mesh& mesh) {
  const surface::Surface& from = state.surface;
  surface::Surface copy{copy_of(ex, from.positions), copy_of(ex, from.normals), copy_of(ex, from.triangles)};
  download_mesh(ex, state.field, std::move(copy), settings.options.reconstruction, settings.origin, mesh);
  ex.synchronize();
}

template <exec::Space Exec>
Cloud copy_cloud(Exec& ex, const Settings& settings, const State& state) {
  const PointBuffers& points = state.points;
  Cloud cloud;
  cloud.origin = settings.origin;
  copy_out(ex, points.positions, cloud.positions);
  copy_out(ex, points.normals, cloud.normals);
  for (const detail::AttributeBuffer& attribute : points.attributes)
    cloud.attributes.push_back({attribute.name, exec::download_typed(ex, exec::copy_typed(ex, attribute.values))});
  std::vector<std::uint8_t> kinds;
  copy_out(ex, points.added, kinds);
  cloud.attributes.push_back({"added", std::move(kinds)});
  return cloud;
}

PSK_INSTANTIATE(begin_session);
PSK_INSTANTIATE(make_next);
PSK_INSTANTIATE(show);
PSK_INSTANTIATE(copy_cloud);

}  // namespace pointskin::edit
