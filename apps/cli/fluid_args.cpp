#include "fluid_args.hpp"

#include "args.hpp"
#include "commands.hpp"
#include "frame_files.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

void define_files(CLI::App& command, FluidArgs& args) {
  const std::string group = "Files";
  command.add_option("IN", args.input, "particles of a frame, or frame_{}.vtk for a sequence; - reads stdin");
  command
      .add_option("-o,--output", args.output, "mesh: .ply, .obj or .stl, {} where IN has it; - writes PLY to stdout")
      ->type_name("OUT")
      ->group(group);
  command.add_option("--first", args.first, "number of the first frame of a sequence")->type_name("N")->group(group);
  command.add_option("--last", args.last, "number of the last frame of a sequence")->type_name("N")->group(group);
  command.add_option("--report", args.report, "write what was done as JSON; also measures the meshes")
      ->type_name("FILE")
      ->group(group);
  add_overwrite_option(command, args.overwrite);
  command.add_option("--shift", args.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

void define_surface(CLI::App& command, FluidArgs& args) {
  const std::string group = "Surface (lengths in particle radii)";
  FluidOptions& options = args.options;
  const auto value = [&](const char* name, auto& target, const char* type, const char* description) {
    return command.add_option(name, target, description)->type_name(type)->group(group);
  };
  value("-r,--particle-radius", options.particle_radius, "R", "half of the particles' distance at rest, world units");
  value("-c,--cube-size", options.cube_size, "C", "width of the finest cells, 0.05 to 4")->capture_default_str();
  value("-l,--smoothing-length", options.smoothing_length, "L", "half of the kernel's radius, 1 to 8")
      ->capture_default_str();
  value("--kernel", args.kernel, "K", "isotropic (Zhu & Bridson) or anisotropic (Yu & Turk)")
      ->check(is_one_of({"isotropic", "anisotropic"}))
      ->capture_default_str();
  value("-t,--surface-threshold", options.surface_threshold, "T",
        "isotropic: distance from the mean of particles, 0 to 2 [1];\n"
        "anisotropic: share of the density at rest, 0 to 1 [0.2]");
  command.add_flag("--no-attributes", args.no_attributes, "do not carry properties of the particles to the vertices")
      ->group(group);
  command.add_flag("--no-normals", args.no_normals, "leave vertex normals out of the mesh")->group(group);
}

void define_finish(CLI::App& command, FluidArgs& args) {
  const std::string group = "Finish";
  command
      .add_option("--mesh-smoothing-iters", args.options.smoothing_iterations,
                  "iterations of Laplacian smoothing, 0 to 1000; 25 is plenty")
      ->type_name("N")
      ->group(group)
      ->capture_default_str();
  command.add_flag("--no-smoothing-weights", args.no_weights, "smooth single particles and thin sheets as much as all")
      ->group(group);
  command
      .add_option("--min-component", args.options.min_component,
                  "remove pieces, and fill bubbles, smaller than so many particles; 0: keep all")
      ->type_name("N")
      ->group(group)
      ->capture_default_str();
}

}  // namespace

void define_fluid_options(CLI::App& command, FluidArgs& args) {
  define_files(command, args);
  define_surface(command, args);
  define_finish(command, args);
  define_simulation(command, args.simulation);
  define_device_options(command, args);
  const std::string group = kDeviceGroup;
  command.add_option("--at-once", args.at_once, "frames worked on together on the CPU; 0: as threads and memory allow")
      ->type_name("N")
      ->group(group)
      ->capture_default_str();
  command
      .add_option("--max-memory", args.max_memory,
                  "memory for frames worked on together, e.g. 8G [default: most of what is free]")
      ->type_name("SIZE")
      ->group(group);
  command.add_flag("-q,--quiet", args.quiet, "errors and warnings only")->group("Messages");
}

void warn_about_unused(const FluidArgs& args, bool on_gpu) {
  const GivenOptions& given = args.given;
  if (args.simulation.scene.empty()) {
    warn_unused(given, {"--frames", "--particles", "--fps", "--iterations", "--viscosity", "--vorticity"},
                "without --simulate");
    if (!is_pattern(args.input))
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
  FluidOptions options = args.options;
  options.kernel = args.kernel == "anisotropic" ? FluidKernel::anisotropic : FluidKernel::isotropic;
  options.normals = !args.no_normals;
  options.attributes = !args.no_attributes;
  options.smoothing_weights = !args.no_weights;
  if (args.simulation.scene.empty() || options.particle_radius != 0) validate(options);
  return options;
}

}  // namespace pointskin::cli
