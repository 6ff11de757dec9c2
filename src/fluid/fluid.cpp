#include <pointskin/error.hpp>
#include <pointskin/fluid.hpp>

#include <cmath>

#include <fmt/format.h>

#include "fluid/engine.hpp"

namespace pointskin {

class FluidSurfacer::Impl {
 public:
  explicit Impl(Device where)
      : device(where),
        engine(where.kind == DeviceKind::cuda ? detail::make_cuda_fluid_engine(where.index)
                                              : detail::make_cpu_fluid_engine(where.threads)) {}

  Device device;
  FluidReport report;
  std::unique_ptr<detail::FluidEngine> engine;
};

FluidSurfacer::FluidSurfacer(Device device) : impl_(std::make_unique<Impl>(device)) {}
FluidSurfacer::~FluidSurfacer() = default;
FluidSurfacer::FluidSurfacer(FluidSurfacer&&) noexcept = default;
FluidSurfacer& FluidSurfacer::operator=(FluidSurfacer&&) noexcept = default;

Mesh FluidSurfacer::surface(const Cloud& particles, const FluidOptions& options) {
  Mesh mesh;
  surface(particles, options, mesh);
  return mesh;
}

void FluidSurfacer::surface(const Cloud& particles, const FluidOptions& options, Mesh& mesh) {
  validate(options);
  impl_->engine->surface(particles, options, mesh, impl_->report);
}

const FluidReport& FluidSurfacer::report() const { return impl_->report; }
const Device& FluidSurfacer::device() const { return impl_->device; }

void validate(const FluidOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* range) {
    if (!holds) throw Error(ErrorCode::usage, fmt::format("option {} must be {}, but is {}", name, range, value));
  };
  const auto in = [](double value, double low, double high) { return value >= low && value <= high; };  // not NaN
  require(options.particle_radius > 0 && std::isfinite(options.particle_radius), "particle_radius",
          options.particle_radius, "positive and finite");
  require(in(options.smoothing_length, 1, 8), "smoothing_length", options.smoothing_length, "in 1..8");
  require(in(options.cube_size, 0.05, 4), "cube_size", options.cube_size, "in 0.05..4");
  const double most = options.kernel == FluidKernel::anisotropic ? 1 : 2;
  require(in(options.surface_threshold, 0, most), "surface_threshold", options.surface_threshold,
          options.kernel == FluidKernel::anisotropic ? "in 0..1" : "in 0..2");
  require(in(options.smoothing_iterations, 0, 1000), "smoothing_iterations", options.smoothing_iterations,
          "in 0..1000");
  require(options.min_component >= 0 && std::isfinite(options.min_component), "min_component", options.min_component,
          "finite and not negative");
}

}  // namespace pointskin
