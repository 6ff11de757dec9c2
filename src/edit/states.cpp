#include "edit/states.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <variant>
#include <vector>

#include "core/stopwatch.hpp"
#include "edit/base.hpp"
#include "edit/change.hpp"
#include "edit/points.hpp"
#include "exec/this_space.hpp"
#include "exec/typed_buffer.hpp"
#include "octree/frame.hpp"
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
void extract(Exec& ex, const Settings& settings, State& state) {
  RunReport unused;
  state.surface = extract_some(ex, state.field, settings.options.reconstruction, unused);
}

const char* name_of(const Operation& operation) {
  constexpr const char* kNames[] = {"guide", "remove", "insert", "flip"};
  static_assert(std::size(kNames) == std::variant_size_v<Operation>);
  return kNames[operation.index()];
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

void describe(const Operation& operation, const Change& change, StepReport& report) {
  report.operation = name_of(operation);
  report.added = change.added.positions.size();
  report.removed = change.removed.size();
  report.flipped = change.flipped.size();
  report.snapped = change.snapped;
}

EditInput input_of(const Settings& settings, const State& state) {
  return {state.points,           state.field,
          settings.origin,        settings.base_box,
          settings.normal_length, settings.options.reconstruction};
}

/// Positions and normals on the host.
template <exec::Space Exec>
Cloud cloud_of(Exec& ex, const PointBuffers& points, const Vec3d& origin) {
  Cloud cloud;
  cloud.origin = origin;
  copy_out(ex, points.positions, cloud.positions);
  copy_out(ex, points.normals, cloud.normals);
  return cloud;
}

}  // namespace

template <exec::Space Exec>
void make_whole(Exec& ex, State& state) {
  if (state.is_slim()) state.field.samples = detail::samples_of(ex, state.points, state.field.frame);
}

template <exec::Space Exec>
Beginning begin_session(Exec& ex, const Cloud& base, const EditOptions& options) {
  Settings settings{options, base.origin, {}, {}, 1};
  Options& reconstruction = settings.options.reconstruction;
  reconstruction.residuals = false;  // nobody sees them, and they cost more than the solve
  settings.envelope = detail::make_envelope(ex, reconstruction, base.origin);
  const std::int64_t held = ex.pool()->held_bytes();
  auto state = std::make_shared<State>();
  BaseFit fitted = fit_base(ex, base, settings.options, settings.envelope);
  state->points = std::move(fitted.points);
  state->field = std::move(fitted.field);
  settings.base_box = fitted.box;
  settings.normal_length = fitted.normal_length;
  extract(ex, settings, *state);
  state->bytes = ex.pool()->held_bytes() - held;
  return {std::move(settings), std::move(state)};
}

template <exec::Space Exec>
SharedState make_next(Exec& ex, const Settings& settings, const SharedState& before, const Operation& operation,
                      StepReport& report) {
  Stopwatch watch;
  const std::int64_t held = ex.pool()->held_bytes();
  Change change = find_change(ex, input_of(settings, *before), operation);
  describe(operation, change, report);
  std::shared_ptr<State> state;
  if (!change.is_none()) state = std::make_shared<State>(State{changed_points(ex, before->points, change), {}, {}, 0});
  change = {};  // the fit needs the memory
  report.edit_ms = lap(ex, watch);
  if (state != nullptr) {
    report.warm = fit(ex, settings, *before, std::holds_alternative<Insert>(operation), *state);
    extract(ex, settings, *state);
    state->bytes = ex.pool()->held_bytes() - held;
  }
  const SharedState next = state != nullptr ? std::move(state) : before;
  report.reconstruct_ms = lap(ex, watch);
  report.points = next->points.positions.size();
  return next;
}

template <exec::Space Exec>
EditPreview preview(Exec& ex, const Settings& settings, const State& state, const Operation& operation) {
  const Change change = find_change(ex, input_of(settings, state), operation);
  if (change.flipped.empty())
    return {cloud_of(ex, change.added, settings.origin),
            cloud_of(ex, choose(ex, state.points, change.removed.cview()), settings.origin)};
  PointBuffers turned = choose(ex, state.points, change.flipped.cview());
  EditPreview preview;
  preview.removed = cloud_of(ex, turned, settings.origin);
  turn_normals(ex, exec::iota(ex, turned.normals.size()).cview(), turned.normals.view());
  preview.added = cloud_of(ex, turned, settings.origin);
  return preview;
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
  Cloud cloud = cloud_of(ex, points, settings.origin);
  for (const detail::AttributeBuffer& attribute : points.attributes)
    if (attribute.name != kKinds)
      cloud.attributes.push_back({attribute.name, exec::download_typed(ex, exec::copy_typed(ex, attribute.values))});
  std::vector<std::uint8_t> kinds;
  copy_out(ex, points.added, kinds);
  cloud.attributes.push_back({kKinds, std::move(kinds)});
  return cloud;
}

PSK_INSTANTIATE(make_whole);
PSK_INSTANTIATE(begin_session);
PSK_INSTANTIATE(make_next);
PSK_INSTANTIATE(preview);
PSK_INSTANTIATE(show);
PSK_INSTANTIATE(copy_cloud);

}  // namespace pointskin::edit
