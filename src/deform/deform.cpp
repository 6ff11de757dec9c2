#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>

#include <fmt/format.h>

#include "deform/engine.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin {

class Deformer::Impl {
 public:
  Impl(const Cloud& rest, const Options& options, Device device) : device_(device), points_(rest.size()) {
    detail::validate_settled(options);
    check_memory(rest, options);
    engine_ = device.kind == DeviceKind::cuda ? detail::make_cuda_deform_engine(device.index, rest, options, report_)
                                              : detail::make_cpu_deform_engine(device.threads, rest, options, report_);
  }

  void check_memory(const Cloud& rest, const Options& options) const {
    if (options.max_memory_bytes == 0) return;
    const std::int64_t needed = 2 * estimate_device_bytes(rest, options, device_.threads);
    if (needed > options.max_memory_bytes)
      throw Error(ErrorCode::over_limit,
                  fmt::format("the field at rest and a frame would need about {} MB of the {} MB allowed; choose a "
                              "smaller depth or allow more",
                              needed / 1'000'000, options.max_memory_bytes / 1'000'000));
  }

  Device device_;
  std::int64_t points_;
  DeformReport report_;
  std::unique_ptr<detail::DeformEngine> engine_;
};

Deformer::Deformer(const Cloud& rest, const Options& options, Device device)
    : impl_(std::make_unique<Impl>(rest, options, device)) {}
Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;

void Deformer::deform(const Deformation& deformation) {
  validate(deformation, impl_->points_);
  impl_->engine_->deform(deformation, impl_->report_);
}

Mesh Deformer::reconstruct() {
  Mesh mesh;
  reconstruct(mesh);
  return mesh;
}

void Deformer::reconstruct(Mesh& mesh) { impl_->engine_->reconstruct(mesh, impl_->report_); }
Cloud Deformer::cloud() const { return impl_->engine_->cloud(); }
SpacingRatios Deformer::spacing() const { return impl_->engine_->spacing(); }
const DeformReport& Deformer::report() const { return impl_->report_; }
const Device& Deformer::device() const { return impl_->device_; }

}  // namespace pointskin
