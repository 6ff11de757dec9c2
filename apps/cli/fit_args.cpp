#include "fit_args.hpp"

#include <cmath>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "commands.hpp"

namespace pointskin::cli {
namespace {

bool confidence_of(const std::string& exponent) {
  if (exponent == "true" || exponent == "false") return exponent == "true";
  const double value = parse_number(exponent).value_or(-1);
  if (value == 0 || value == 1) return value == 1;
  throw Error(ErrorCode::usage,
              fmt::format("--confidence: {} is not 0 or 1; other exponents are not supported", exponent));
}

Boundary boundary_of(const std::string& name) {
  if (name == "dirichlet") return Boundary::dirichlet;
  if (name == "free" || name == "neumann") return Boundary::free;
  throw Error(ErrorCode::usage, fmt::format("--boundary: '{}' is not free, dirichlet or neumann", name));
}

/// "auto", or a whole number.
int depth_of(const std::string& text) {
  if (text == "auto") return Options::kAutomaticDepth;
  const double value = parse_number(text).value_or(-1);
  if (value >= 1 && value <= 20 && value == std::floor(value)) return static_cast<int>(value);
  throw Error(ErrorCode::usage, fmt::format("--depth: '{}' is not a whole number from 1 to 20 or auto", text));
}

/// "auto", or a share.
double trim_of(const std::string& text) {
  if (text == "auto") return Options::kAutomaticTrim;
  const double value = parse_number(text).value_or(-1);
  if (value >= 0 && value < 1) return value;
  throw Error(ErrorCode::usage, fmt::format("--trim: '{}' is not a number from 0 to below 1 or auto", text));
}

FieldKind field_of(const std::string& name) {
  if (name == "poisson") return FieldKind::poisson;
  if (name == "distance") return FieldKind::distance;
  throw Error(ErrorCode::usage, fmt::format("--field: '{}' is not poisson or distance", name));
}

Options with_words(const SolveArgs& args) {
  Options options = args.options;
  options.depth = depth_of(args.depth);
  options.normals = !args.no_normals;
  options.boundary = boundary_of(args.boundary);
  return options;
}

}  // namespace

Device DeviceArgs::chosen() const { return parse_device(device, threads); }

std::string needs_a_name(const std::string& file) { return file.empty() ? "needs the name of a file" : ""; }

void define_device_options(CLI::App& command, DeviceArgs& args) {
  command.add_option("--device", args.device, "auto, cpu, cuda or cuda:N")
      ->type_name("DEV")
      ->group(kDeviceGroup)
      ->capture_default_str();
  add_threads_option(command, args.threads, kDeviceGroup);
}

void define_solve_options(CLI::App& command, SolveArgs& args) {
  Options& options = args.options;
  add_surface_value(command, "--depth", args.depth, "octree depth D in levels, 1 to 20; cells are cube / 2^D wide")
      ->type_name("D")
      ->each([&args](const std::string&) { args.depth_given = true; });
  add_surface_value(command, "--screening", options.screening, "weight of the points, no unit, >= 0; 0: unscreened")
      ->type_name("W");
  add_surface_value(command, "--iterations", options.iterations, "relaxations per level, 1 to 1000")->type_name("N");
  add_surface_value(command, "--scale", options.scale, "working cube / bounding cube of the points, 1 to 100")
      ->type_name("F");
  add_surface_value(command, "--samples-per-node", options.samples_per_node, "points a cell should hold, 0 to 100")
      ->type_name("N");
  command.add_flag("--fixed-screening", options.fixed_screening, "weigh all points alike, however much they scatter")
      ->group(kSurfaceGroup);
  command.add_flag("--linear-fit", options.linear_fit, "place vertices by linear interpolation (also =on, =off)")
      ->group(kSurfaceGroup);
  add_surface_value(command, "--boundary", args.boundary,
                    "field on the cube's faces: free (also called neumann), or dirichlet: 0")
      ->type_name("B");
  command.add_flag("--keep-strays", options.keep_strays, "use stray points, too, and make the cube for all points")
      ->group(kSurfaceGroup);
  command.add_flag("--no-normals", args.no_normals, "leave vertex normals out of the mesh")->group(kSurfaceGroup);
}

void define_fit_options(CLI::App& command, FitArgs& args) {
  define_solve_options(command, args);
  Options& options = args.options;
  add_surface_value(command, "--field", args.field,
                    "poisson (a field solved for), or distance (to the points' tangent planes)")
      ->type_name("F");
  command.add_flag("--confidence", args.confidence, "the length of a normal is the weight of its point")
      ->group(kSurfaceGroup);
  command.add_flag("--open", args.open, "leave the surface open at the cube's faces, instead of closed")
      ->group(kSurfaceGroup);
  command.add_option("--envelope", args.envelope, "closed mesh that the surface stays inside of [default none]")
      ->type_name("MESH")
      ->group(kSurfaceGroup)
      ->check(needs_a_name);
  add_surface_value(command, "--offset", options.offset,
                    "distance of the mesh from the surface, world units, > 0 outwards")
      ->type_name("D");
  add_surface_value(command, "--trim", args.trim,
                    "cut where samples end: share that counts as sparse, 0 (off) to below 1")
      ->type_name("Q");
  add_surface_value(command, "--island-ratio", options.island_ratio,
                    "trim: smallest piece, share of the area, 0 to below 1")
      ->type_name("R");
  command.add_flag("--largest", options.largest, "keep only the connected piece with the largest area")
      ->group(kSurfaceGroup);
  add_surface_value(command, "--min-component", options.min_component,
                    "leave out smaller pieces: triangles, or below 1 the share of the area; 0: none")
      ->type_name("N|RATIO");
  command.add_flag("--density", options.density, "add the property density, points per world unit^2")
      ->group(kSurfaceGroup);
  command.add_flag("--weakness", options.weakness, "add the property weakness, 0 to 1: how doubtful the topology is")
      ->group(kSurfaceGroup);
  command
      .add_flag("--keep-attributes", options.attributes,
                "carry colours and every other property of the points to the vertices")
      ->group(kSurfaceGroup);
}

Options solve_options(const SolveArgs& args) {
  Options options = with_words(args);
  validate(options);
  return options;
}

Options fit_options(const FitArgs& args) {
  Options options = with_words(args);
  options.trim = trim_of(args.trim);
  options.confidence = confidence_of(args.confidence);
  options.domain_faces = args.open ? DomainFaces::open : DomainFaces::closed;
  options.field = field_of(args.field);
  validate(options);
  return options;
}

}  // namespace pointskin::cli
