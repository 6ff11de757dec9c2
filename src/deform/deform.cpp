#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>

#include "core/format.hpp"
#include "deform/moving_cloud.hpp"
#include "exec/any_space.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin {

namespace {

void check_memory(const Cloud& rest, const Options& options, const Device& device) {
  if (options.max_memory_bytes == 0) return;
  const std::int64_t needed = 2 * estimate_device_bytes(rest, options, device.threads);
  if (needed > options.max_memory_bytes)
    throw Error(ErrorCode::over_limit,
                fmt::format("the field at rest and a frame would need about {} MB of the {} MB allowed; choose a "
                            "smaller depth or allow more",
                            needed / 1'000'000, options.max_memory_bytes / 1'000'000));
}

const Cloud& checked(const Cloud& rest, const Options& options, const Device& device) {
  detail::validate_settled(options);
  check_memory(rest, options, device);
  return rest;
}

}  // namespace

class PSK_HIDDEN Deformer::Impl {
 public:
  Impl(const Cloud& rest, const Options& options, Workspace in)
      : workspace(std::move(in)),
        points(checked(rest, options, workspace.device()).size()),
        moving(
            exec::visit(workspace.data().space, [&](auto& ex) { return deform::start(ex, rest, options, report); })) {}

  Workspace workspace;
  std::int64_t points;
  DeformReport report;
  deform::MovingCloud moving;
};

Deformer::Deformer(const Cloud& rest, const Options& options, Workspace workspace)
    : impl_(std::make_unique<Impl>(rest, options, std::move(workspace))) {}
Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;

void Deformer::deform(const Deformation& deformation) {
  validate(deformation, impl_->points);
  exec::visit(impl_->workspace.data().space,
              [&](auto& ex) { deform::apply(ex, deformation, impl_->moving, impl_->report); });
}

Mesh Deformer::reconstruct() {
  Mesh mesh;
  reconstruct(mesh);
  return mesh;
}

void Deformer::reconstruct(Mesh& mesh) {
  exec::visit(impl_->workspace.data().space,
              [&](auto& ex) { deform::reconstruct(ex, impl_->moving, mesh, impl_->report); });
}

Cloud Deformer::cloud() const {
  return exec::visit(impl_->workspace.data().space, [&](auto& ex) { return deform::copy_cloud(ex, impl_->moving); });
}

SpacingRatios Deformer::spacing() const {
  return exec::visit(impl_->workspace.data().space,
                     [&](auto& ex) { return deform::measure_spacing(ex, impl_->moving); });
}

const DeformReport& Deformer::report() const { return impl_->report; }
const Device& Deformer::device() const { return impl_->workspace.device(); }

}  // namespace pointskin
