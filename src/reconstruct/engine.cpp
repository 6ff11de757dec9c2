#include "reconstruct/engine.hpp"

#include <algorithm>
#include <utility>

#include "exec/any_space.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/thin.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::detail {
namespace {

/// The points of a run with what the mesh may keep of them.
template <exec::Space Exec>
PointBuffers upload_all(Exec& ex, const Input& input, bool attributes, octree::Extent& extent) {
  PointBuffers points = upload(ex, input, &extent);
  if (attributes) points.attributes = upload_attributes(ex, input);
  return points;
}

template <class T>
DeviceSpan<T> span_of(const exec::Buffer<T>& buffer) {
  return {buffer.data(), buffer.size()};
}

}  // namespace

DeviceMesh handle_of(const Workspace& workspace, MeshBuffers mesh, const Vec3d& origin) {
  struct Owner {
    Workspace workspace;  // goes last
    MeshBuffers mesh;
  };
  const auto owner = std::make_shared<const Owner>(Owner{workspace, std::move(mesh)});
  const MeshBuffers& kept = owner->mesh;
  DeviceMesh handle;
  handle.origin = origin;
  handle.vertices = span_of(kept.surface.positions);
  handle.normals = span_of(kept.surface.normals);
  handle.triangles = span_of(kept.surface.triangles);
  for (std::size_t a = 0; a < kept.names.size(); ++a) {
    const exec::TypedBuffer& values = kept.attributes[a];
    handle.attributes.push_back({kept.names[a], values.type, values.bytes.data(), values.missing.data()});
  }
  handle.owner = owner;
  return handle;
}

FieldImpl::FieldImpl(Workspace workspace, FieldData data, Options options, const Vec3d& origin)
    : workspace_(std::move(workspace)), data_(std::move(data)), options_(std::move(options)), origin_(origin) {
  options_.progress = nullptr;  // it may refer to what the caller no longer has
}

Vec3d FieldImpl::cube_lower_world() const { return origin_ + data_.frame.lower; }

std::vector<float> FieldImpl::values(std::span<const Vec3d> points_world) const {
  return exec::visit(workspace_.data().space, [&](auto& ex) { return values_at(ex, data_, origin_, points_world); });
}

Options FieldImpl::with(const ExtractOptions& options) const {
  const Options all(options_, options, options_);
  validate(all);
  return all;
}

void FieldImpl::extract(const ExtractOptions& options, Mesh& mesh) const {
  const Options all = with(options);
  exec::visit(workspace_.data().space, [&](auto& ex) {
    RunReport unused;
    download_mesh(ex, data_, extract_some(ex, data_, all, unused), all, origin_, mesh);
  });
}

DeviceMesh FieldImpl::extract_on_device(const ExtractOptions& options) const {
  const Options all = with(options);
  return exec::visit(workspace_.data().space, [&](auto& ex) {
    RunReport unused;
    return handle_of(workspace_, mesh_in_space(ex, data_, extract_some(ex, data_, all, unused), all), origin_);
  });
}

void FieldImpl::extract_and_release(Mesh& mesh, RunReport& report) {
  exec::visit(workspace_.data().space,
              [&](auto& ex) { detail::extract_and_release(ex, data_, options_, origin_, mesh, report); });
}

DeviceMesh FieldImpl::extract_and_release(RunReport& report) {
  return exec::visit(workspace_.data().space, [&](auto& ex) {
    PhaseClock clock(ex);
    surface::Surface surface = extract_some(ex, data_, options_, report);
    look_at_surface(ex, surface, data_);
    MeshBuffers mesh = mesh_in_space(ex, data_, std::move(surface), options_);
    clock.lap(report.extract_ms);
    const diagnose::Counts seen = data_.seen;
    data_ = {};
    data_.seen = seen;
    clock.read();
    report.device_peak_bytes = ex.pool()->peak_bytes();
    return handle_of(workspace_, std::move(mesh), origin_);
  });
}

void Engine::limit_memory(std::int64_t bytes) const { workspace_.data().space.pool()->set_limit(bytes); }

bool Engine::has_lasting_limit() const { return workspace_.data().space.pool()->lasting_limit() > 0; }

std::shared_ptr<FieldImpl> Engine::solve(const Input& input, const Options& options, bool keep_all, RunReport& report,
                                         const std::optional<Bounds>& core) const {
  return exec::visit(workspace_.data().space, [&](auto& ex) {
    ex.pool()->reset_peak();
    std::shared_ptr<const envelope::Envelope> envelope = make_envelope(ex, options, input.origin());
    PhaseClock clock(ex);
    octree::Extent extent;
    PointBuffers points = upload_all(ex, input, keep_all || options.attributes, extent);
    clock.lap(report.upload_ms);
    FieldData data =
        fit_field(ex, points,
                  {.extent = extent, .core = core, .envelope = std::move(envelope), .keep_all = keep_all, .look = true},
                  options, report);
    clock.read();
    for (Vec3d& p : report.farthest_strays)
      for (std::size_t a = 0; a < 3; ++a) p[a] += input.origin()[a];
    report.device_peak_bytes = ex.pool()->peak_bytes();
    return std::make_shared<FieldImpl>(workspace_, std::move(data), options, input.origin());
  });
}

Cloud Engine::thin(const Input& input, const Options& options, std::int64_t count) const {
  return exec::visit(workspace_.data().space, [&](auto& ex) { return thin_cloud(ex, input, options, count); });
}

Detail Engine::measure_detail(const Input& input, const Options& options) const {
  return exec::visit(workspace_.data().space, [&](auto& ex) { return detail::measure_detail(ex, input, options); });
}

Cloud Engine::copy(const Input& input) const {
  if (input.cloud() != nullptr) return *input.cloud();
  return exec::visit(workspace_.data().space, [&](auto& ex) { return download_points(ex, *input.points()); });
}

std::int64_t bytes_of_run(const Engine& engine, const Input& input, const Options& options) {
  const int threads = engine.workspace().device().threads;
  if (input.cloud() != nullptr) return estimate_device_bytes(*input.cloud(), options, threads);
  return estimate_device_bytes(engine.copy(input), options, threads);
}

}  // namespace pointskin::detail

namespace pointskin {

UploadedCloud upload(const Workspace& workspace, const Cloud& cloud) {
  struct Owner {
    Workspace workspace;  // goes last
    detail::PointBuffers points;
  };
  return exec::visit(workspace.data().space, [&](auto& ex) {
    const auto owner = std::make_shared<const Owner>(Owner{workspace, detail::copy_points(ex, cloud)});
    UploadedCloud uploaded;
    uploaded.origin = cloud.origin;
    uploaded.positions = {owner->points.positions.data(), owner->points.positions.size()};
    uploaded.normals = {owner->points.normals.data(), owner->points.normals.size()};
    for (const detail::AttributeBuffer& from : owner->points.attributes)
      uploaded.attributes.push_back(
          {from.name, from.values.type, from.values.bytes.data(), from.values.missing.data()});
    uploaded.owner = owner;
    return uploaded;
  });
}

Mesh download(const Workspace& workspace, const DeviceMesh& mesh) {
  return exec::visit(workspace.data().space, [&](auto& ex) { return detail::download_mesh_of(ex, mesh); });
}

Cloud download(const Workspace& workspace, const DevicePoints& points) {
  return exec::visit(workspace.data().space, [&](auto& ex) { return detail::download_points(ex, points); });
}

}  // namespace pointskin
