#include <pointskin/fluid.hpp>

#include "c/convert.hpp"
#include "c/defaults.hpp"
#include "c/points_input.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

FluidOptions fluid_options_of(const psk_fluid_options* given) {
  const psk_fluid_options from = known(given);
  FluidOptions to;
  to.particle_radius = from.particle_radius;
  to.kernel = enumerator("kernel", from.kernel, FluidKernel::anisotropic);
  to.smoothing_length = from.smoothing_length;
  to.cube_size = from.cube_size;
  to.surface_threshold = from.surface_threshold;
  to.smoothing_iterations = from.smoothing_iterations;
  to.smoothing_weights = from.smoothing_weights != 0;
  to.min_component = from.min_component;
  to.normals = from.normals != 0;
  to.attributes = from.attributes != 0;
  return to;
}

}  // namespace

psk_code psk_fluid_create(psk_workspace* workspace, psk_fluid** fluid, psk_error* error) {
  return guarded(error, [&] {
    const Workspace& where = required(workspace, "workspace").workspace;
    required(fluid, "fluid") = new psk_fluid{FluidSurfacer(where), where};
  });
}

void psk_fluid_free(psk_fluid* fluid) { delete fluid; }

psk_code psk_fluid_surface(psk_fluid* fluid, const psk_cloud* particles, const psk_fluid_options* options,
                           psk_mesh** mesh, psk_error* error) {
  return guarded(error, [&] {
    required(mesh, "mesh") = new_mesh(
        required(fluid, "fluid").surfacer.surface(required(particles, "particles").cloud, fluid_options_of(options)));
  });
}

psk_code psk_fluid_surface_points(psk_fluid* fluid, const psk_points* particles, const psk_fluid_options* options,
                                  int32_t memory, psk_mesh** mesh, psk_error* error) {
  return guarded(error, [&] {
    psk_fluid& from = required(fluid, "fluid");
    with_device_points(from.workspace, particles, [&](const DevicePoints& input) {
      required(mesh, "mesh") =
          new_mesh(from.workspace, from.surfacer.surface(input, fluid_options_of(options)), memory);
    });
  });
}

psk_code psk_fluid_get_report(const psk_fluid* fluid, psk_fluid_report* report, psk_error* error) {
  return guarded(error, [&] {
    const FluidReport& from = required(fluid, "fluid").surfacer.report();
    auto to = defaults<psk_fluid_report>();
    to.particles = from.particles;
    to.coarse_corners = from.coarse_corners;
    to.fine_corners = from.fine_corners;
    to.removed_components = from.removed_components;
    to.device_peak_bytes = from.device_peak_bytes;
    to.upload_ms = from.upload_ms;
    to.particles_ms = from.particles_ms;
    to.field_ms = from.field_ms;
    to.extract_ms = from.extract_ms;
    to.finish_ms = from.finish_ms;
    to.download_ms = from.download_ms;
    to.depth = from.depth;
    to.rounds = from.rounds;
    give(to, &required(report, "report"));
  });
}
