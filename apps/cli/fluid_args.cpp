#include "fluid_args.hpp"

#include <pointskin/formats.hpp>

#include "args.hpp"
#include "scene/frame_files.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

OptionGroup file_options(FluidArgs& args) {
  return {
      "Files",
      {option("IN", "particles of a frame, or frame_{}.vtk for a sequence; - reads stdin", &args.input,
              {"input", 60, kNeverNull}),
       option("-o,--output OUT",
              "mesh: " + extension_list(&FormatInfo::writes_meshes) + "; {} where IN has it; - writes PLY to stdout",
              &args.output, {"output", 61, kNeverNull}),
       option("--first N", "number of the first frame of a sequence", &args.first, {"first", 50}),
       option("--last N", "number of the last frame of a sequence", &args.last, {"last", 51}),
       option("--report FILE", "write what was done as JSON; also measures the meshes", &args.report),
       overwrite_row(args.overwrite), shift_row(args.shift)}};
}

OptionGroup surface_options(FluidOptions& o) {
  const auto threshold = [&o] { return o.surface_threshold == 0 ? Shown("default") : Shown(o.surface_threshold); };
  const auto kernel =
      one_of<FluidKernel>(o.kernel, {{"isotropic", FluidKernel::isotropic}, {"anisotropic", FluidKernel::anisotropic}});
  return {
      "Surface (lengths in particle radii)",
      {option("-r,--particle-radius R", "half of the particles' distance at rest, world units", &o.particle_radius,
              {"particle_radius", 1, kFromZero}, {.no_default = true}),
       option("-c,--cube-size C", "width of the finest cells, 0.05 to 4", &o.cube_size, {"cube_size", 4, kFromZero}),
       option("-l,--smoothing-length L", "half of the kernel's radius, 1 to 8", &o.smoothing_length,
              {"smoothing_length", 3, kFromOne}),
       option("--kernel K", "isotropic (Zhu & Bridson) or anisotropic (Yu & Turk)", kernel, {"kernel", 2},
              {.check = is_one_of(kernel.words)}),
       option("-t,--surface-threshold T",
              "isotropic: distance from the mean of particles, 0 to 2 [1];\n"
              "anisotropic: share of the density at rest, 0 to 1 [0.2]",
              shown_as(&o.surface_threshold, threshold), {"surface_threshold", 5, R"({"type": ["number", "string"]})"},
              {.no_default = true}),
       option("--no-attributes", "do not carry properties of the particles to the vertices", negated(o.attributes),
              {"attributes", 10}),
       option("--no-normals", "leave vertex normals out of the mesh", negated(o.normals), {"normals", 9})}};
}

OptionGroup finish_options(FluidOptions& o) {
  return {"Finish",
          {option("--mesh-smoothing-iters N", "iterations of Laplacian smoothing, 0 to 1000; 25 is plenty",
                  &o.smoothing_iterations, {"smoothing_iterations", 6, kFromZero}),
           option("--no-smoothing-weights", "smooth single particles and thin sheets as much as all",
                  negated(o.smoothing_weights), {"smoothing_weights", 7}),
           option("--min-component N", "remove pieces, and fill bubbles, smaller than so many particles; 0: keep all",
                  &o.min_component, {"min_component", 8, kFromZero})}};
}

}  // namespace

OptionTable fluid_options(FluidArgs& args) {
  return {
      file_options(args),
      surface_options(args.options),
      finish_options(args.options),
      simulation_options(args.simulation).unreported(),
      device_options(args),
      {kDeviceGroup,
       {option("--at-once N", "frames worked on together on the CPU; 0: as threads and memory allow", &args.at_once),
        option("--max-memory SIZE", "memory for frames worked on together, e.g. 8G [default: most of what is free]",
               &args.max_memory)}},
      quiet_option(args.quiet)};
}

OptionTable simulation_report_options(FluidArgs& args) {
  OptionGroup surface = surface_options(args.options), files = file_options(args), lengths, output;
  lengths.rows = {surface.row("--cube-size"), surface.row("--smoothing-length")};
  lengths.rows[0].report.place = 20;
  lengths.rows[1].report.place = 21;
  output.rows = {files.row("--output")};
  output.rows[0].report.schema.clear();
  return {simulation_options(args.simulation), lengths, device_options(args), output};
}

void warn_about_unused(const FluidArgs& args, bool on_gpu) {
  const GivenOptions& given = args.given;
  if (args.simulation.scene.empty()) {
    warn_unused(given, {"--frames", "--particles", "--fps", "--iterations", "--viscosity", "--vorticity"},
                "without --simulate");
    if (!scene::is_pattern(args.input))
      warn_unused(given, {"--at-once", "--max-memory"}, "on a single frame");
    else if (on_gpu)
      warn_unused(given, {"--at-once", "--max-memory"}, "on a GPU, which takes one frame after another");
  } else {
    warn_unused(given, {"--shift", "--at-once", "--max-memory", "--overwrite"}, "with --simulate");
    if (args.output.empty())
      warn_unused(given,
                  {"--particle-radius", "--cube-size", "--smoothing-length", "--kernel", "--surface-threshold",
                   "--mesh-smoothing-iters", "--min-component", "--no-attributes", "--no-normals"},
                  kNoMesh);
  }
  if (args.options.smoothing_iterations == 0)
    warn_unused(given, {"--no-smoothing-weights"}, "without --mesh-smoothing-iters");
}

FluidOptions library_options(const FluidArgs& args) {
  const FluidOptions& options = args.options;
  if (args.simulation.scene.empty() || options.particle_radius != 0) validate(options);
  return options;
}

}  // namespace pointskin::cli
