#include <pointskin/error.hpp>
#include <pointskin/fluid.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "exec/any_space.hpp"
#include "fluid/frames.hpp"
#include "reconstruct/engine.hpp"
#include "reconstruct/phase_clock.hpp"

namespace pointskin {

namespace {

/// Particles so far away that double does not tell them apart, once the origin is put back, have no surface.
void check_origin(const Vec3d& origin, const FluidOptions& options) {
  constexpr double kStep = 0x1p-52;  // between doubles, of their magnitude
  const double reach = std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
  const double cell = options.cube_size * options.particle_radius;
  if (reach * kStep > cell)
    throw Error(
        ErrorCode::invalid_input,
        fmt::format("particles lie {:.3g} from the origin, where coordinates are {:.3g} apart, but cells of the "
                    "surface are {:.3g} wide; move the particles nearer to the origin, or take a larger radius",
                    reach, reach * kStep, cell));
}

}  // namespace

class PSK_HIDDEN FluidSurfacer::Impl {
 public:
  /// Calls finish(ex, surface, names) in the space.
  template <class Finish>
  auto surface(const detail::Input& input, const Vec3d& origin, const FluidOptions& options, const Finish& finish) {
    validate(options);
    check_origin(origin, options);
    report = {};
    return exec::visit(workspace.data().space, [&](auto& ex) {
      ex.pool()->reset_peak();
      detail::PhaseClock clock(ex);
      fluid::Frame frame = fluid::load_frame(ex, input, options);
      clock.lap(report.upload_ms);
      clock.read();
      fluid::FluidSurface made = fluid::make_surface(ex, frame.particles, options, report);
      const std::vector<std::string> names = frame.names();
      frame = {};
      return finish(ex, std::move(made), names);
    });
  }

  Workspace workspace;
  FluidReport report{};
};

FluidSurfacer::FluidSurfacer(Workspace workspace) : impl_(std::make_unique<Impl>(Impl{std::move(workspace)})) {}
FluidSurfacer::~FluidSurfacer() = default;
FluidSurfacer::FluidSurfacer(FluidSurfacer&&) noexcept = default;
FluidSurfacer& FluidSurfacer::operator=(FluidSurfacer&&) noexcept = default;

Mesh FluidSurfacer::surface(const Cloud& particles, const FluidOptions& options) {
  Mesh mesh;
  surface(particles, options, mesh);
  return mesh;
}

void FluidSurfacer::surface(const Cloud& particles, const FluidOptions& options, Mesh& mesh) {
  impl_->surface(particles, particles.origin, options,
                 [&](auto& ex, fluid::FluidSurface made, const std::vector<std::string>& names) {
                   fluid::download_surface(ex, std::move(made), names, particles.origin, mesh, impl_->report);
                 });
}

DeviceMesh FluidSurfacer::surface(const DevicePoints& particles, const FluidOptions& options) {
  return impl_->surface(particles, particles.origin, options,
                        [&](auto& ex, fluid::FluidSurface made, const std::vector<std::string>& names) {
                          impl_->report.device_peak_bytes = ex.pool()->peak_bytes();
                          return detail::handle_of(impl_->workspace,
                                                   {std::move(made.mesh), names, std::move(made.values)},
                                                   particles.origin);
                        });
}

const FluidReport& FluidSurfacer::report() const { return impl_->report; }
const Device& FluidSurfacer::device() const { return impl_->workspace.device(); }

void validate(const FluidOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* range) {
    if (!holds) throw Error(ErrorCode::usage, fmt::format("option {} must be {}, but is {}", name, range, value));
  };
  const auto in = [](double value, double low, double high) { return value >= low && value <= high; };  // not NaN
  constexpr double kLargestRadius = 1e18;  // squares of a few of them are floats
  require(options.particle_radius > 0 && options.particle_radius <= kLargestRadius, "particle_radius",
          options.particle_radius, "positive and at most 1e18");
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
