#include "reconstruct_args.hpp"

#include <cmath>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "commands.hpp"

namespace pointskin::cli {
namespace {

void define_files(CLI::App& command, ReconstructArgs& args) {
  const std::string group = "Files";
  command.add_option("IN", args.inputs, "oriented clouds, merged; - reads stdin");
  command.add_option("-o,--output", args.output, "mesh: .ply, .obj or .stl; - writes PLY to stdout")
      ->type_name("OUT")
      ->group(group);
  command.add_option("--report", args.report, "write what was done as JSON")
      ->type_name("FILE")
      ->group(group)
      ->check([](const std::string& file) { return std::string(file.empty() ? "needs the name of a file" : ""); });
  command.add_option("--shift", args.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

template <class T>
CLI::Option* add_value(CLI::App& command, const std::string& name, T& value, const std::string& description) {
  return command.add_option(name, value, description)->group("Surface")->capture_default_str();
}

constexpr char kLimits[] = "Device and limits";

void define_limits(CLI::App& command, ReconstructArgs& args) {
  const std::string group = kLimits;
  command
      .add_option("--max-memory", args.max_memory, "refuse to start above this estimate, e.g. 8G [default no limit]")
      ->type_name("BYTES")
      ->group(group);
  command.add_flag("--dry-run", args.dry_run, "print the memory estimate and stop")->group(group);
}

void define_messages(CLI::App& command, ReconstructArgs& args) {
  const std::string group = "Messages";
  command.add_option("--repeat", args.repeat, "run N more times on data in memory and time it")
      ->type_name("N")
      ->group(group)
      ->each([&args](const std::string&) { args.repeat_given = true; });
  CLI::Option* quiet = command.add_flag("-q,--quiet", args.quiet, "errors and warnings only")->group(group);
  command.add_flag("-v,--verbose", args.verbose, "add the levels of the solve")->group(group)->excludes(quiet);
}

/// Names that scripts written for PoissonRecon use.
void define_poisson_recon_names(CLI::App& command, ReconstructArgs& args) {
  const std::string group = "Names of PoissonRecon";
  const auto alias = [&](const std::string& name, auto& value, const std::string& ours, const std::string& type) {
    CLI::Option* option = command.add_option(name, value, "same as " + ours)->type_name(type)->group(group);
    if (ours != "IN") option->excludes(command.get_option(ours));
  };
  command.add_option("--in", args.named_inputs, "same as IN")->type_name("FILE")->group(group)->allow_extra_args(false);
  alias("--out", args.output, "--output", "OUT");
  alias("--pointWeight", args.options.screening, "--screening", "W");
  alias("--samplesPerNode", args.options.samples_per_node, "--samples-per-node", "N");
  command.add_option("--bType", args.boundary_type, "same as --boundary: 1 free, 2 dirichlet, 3 neumann")
      ->type_name("1|2|3")
      ->group(group)
      ->excludes(command.get_option("--boundary"))
      ->check(CLI::IsMember({1, 2, 3}));
  command.add_option("--width", args.width_world, "widest finest cell, world units; chooses the depth")
      ->type_name("W")
      ->group(group)
      ->each([&args](const std::string&) { args.width_given = true; });
  command.add_flag("--colors", args.colors, "same as --keep-attributes, but for red, green and blue alone")
      ->group(group);
}

bool confidence_of(const std::string& exponent) {
  if (exponent == "true" || exponent == "false") return exponent == "true";
  const double value = parse_number(exponent).value_or(-1);
  if (value == 0 || value == 1) return value == 1;
  throw Error(ErrorCode::usage,
              fmt::format("--confidence: {} is not 0 or 1; other exponents are not supported", exponent));
}

Boundary boundary_of(const ReconstructArgs& args) {
  if (args.boundary_type != 0) return args.boundary_type == 2 ? Boundary::dirichlet : Boundary::free;
  if (args.boundary == "dirichlet") return Boundary::dirichlet;
  if (args.boundary == "free" || args.boundary == "neumann") return Boundary::free;
  throw Error(ErrorCode::usage, fmt::format("--boundary: '{}' is not free, dirichlet or neumann", args.boundary));
}

FieldKind field_of(const std::string& name) {
  if (name == "poisson") return FieldKind::poisson;
  if (name == "distance") return FieldKind::distance;
  throw Error(ErrorCode::usage, fmt::format("--field: '{}' is not poisson or distance", name));
}

}  // namespace

void define_surface_options(CLI::App& command, ReconstructArgs& args) {
  Options& options = args.options;
  command.add_option("--depth", options.depth, "octree depth D in levels, 1 to 20; cells are cube / 2^D wide")
      ->type_name("D")
      ->group("Surface")
      ->capture_default_str()
      ->each([&args](const std::string&) { args.depth_given = true; });
  add_value(command, "--field", args.field, "poisson (a field solved for), or distance (to the points' tangent planes)")
      ->type_name("F");
  add_value(command, "--screening", options.screening, "weight of the points, no unit, >= 0; 0: unscreened")
      ->type_name("W");
  add_value(command, "--iterations", options.iterations, "relaxations per level, 1 to 1000")->type_name("N");
  add_value(command, "--scale", options.scale, "working cube / bounding cube of the points, 1 to 100")->type_name("F");
  add_value(command, "--samples-per-node", options.samples_per_node, "points a cell should hold, 0 to 100")
      ->type_name("N");
  command.add_flag("--confidence", args.confidence, "the length of a normal is the weight of its point")
      ->group("Surface");
  command.add_flag("--fixed-screening", options.fixed_screening, "weigh all points alike, however much they scatter")
      ->group("Surface");
  command.add_flag("--linear-fit", options.linear_fit, "place vertices by linear interpolation (also =on, =off)")
      ->group("Surface");
  command.add_flag("--open", args.open, "leave the surface open at the cube's faces, instead of closed")
      ->group("Surface");
  add_value(command, "--boundary", args.boundary,
            "field on the cube's faces: free (also called neumann), or dirichlet: 0")
      ->type_name("B");
  command.add_option("--envelope", args.envelope, "closed mesh that the surface stays inside of [default none]")
      ->type_name("MESH")
      ->group("Surface")
      ->check([](const std::string& file) { return std::string(file.empty() ? "needs the name of a file" : ""); });
  add_value(command, "--offset", options.offset, "distance of the mesh from the surface, world units, > 0 outwards")
      ->type_name("D");
  add_value(command, "--trim", options.trim, "cut where samples end: share that counts as sparse, 0 (off) to below 1")
      ->type_name("Q");
  add_value(command, "--island-ratio", options.island_ratio, "trim: smallest piece, share of the area, 0 to below 1")
      ->type_name("R");
  command.add_flag("--density", options.density, "add the property density, points per world unit^2")->group("Surface");
  command.add_flag("--weakness", options.weakness, "add the property weakness, 0 to 1: how doubtful the topology is")
      ->group("Surface");
  command.add_flag("--keep-strays", options.keep_strays, "use stray points, too, and make the cube for all points")
      ->group("Surface");
  command
      .add_flag("--keep-attributes", options.attributes,
                "carry colours and every other property of the points to the vertices")
      ->group("Surface");
  command.add_flag("--no-normals", args.no_normals, "leave vertex normals out of the mesh")->group("Surface");
}

void define_device_options(CLI::App& command, ReconstructArgs& args) {
  command.add_option("--device", args.device, "auto, cpu, cuda or cuda:N")
      ->type_name("DEV")
      ->group(kLimits)
      ->capture_default_str();
  add_threads_option(command, args.threads, kLimits);
}

void define_reconstruct_options(CLI::App& command, ReconstructArgs& args) {
  define_files(command, args);
  define_surface_options(command, args);
  define_device_options(command, args);
  define_limits(command, args);
  define_messages(command, args);
  define_poisson_recon_names(command, args);
}

Options library_options(const ReconstructArgs& args) {
  if (args.width_given && !(args.width_world > 0 && std::isfinite(args.width_world))) {
    throw Error(ErrorCode::usage, fmt::format("--width: {} is not above 0 world units", args.width_world));
  }
  if (args.repeat_given && (args.repeat < 1 || args.repeat > 1'000'000)) {
    throw Error(ErrorCode::usage, fmt::format("--repeat: {} is not in [1, 1000000]", args.repeat));
  }
  Options options = args.options;
  options.confidence = confidence_of(args.confidence);
  options.attributes = options.attributes || args.colors;
  options.normals = !args.no_normals;
  options.domain_faces = args.open ? DomainFaces::open : DomainFaces::closed;
  options.boundary = boundary_of(args);
  options.field = field_of(args.field);
  options.weakness = options.weakness || args.problems;
  options.residuals = args.verbose || !args.report.empty();
  if (!args.max_memory.empty()) options.max_memory_bytes = parse_bytes(args.max_memory);
  validate(options);
  return options;
}

int depth_for_width(double cube_world, double width_world) {
  constexpr int kDeepest = 20;
  int depth = 1;
  while (depth < kDeepest && std::ldexp(cube_world, -depth) > width_world) ++depth;
  if (std::ldexp(cube_world, -depth) <= width_world) return depth;
  throw Error(ErrorCode::usage, fmt::format("--width: cells of {} need more than {} levels in a cube of {}",
                                            width_world, kDeepest, cube_world));
}

}  // namespace pointskin::cli
