#include "boolean_args.hpp"

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "commands.hpp"

namespace pointskin::cli {
namespace {

std::string needs_a_name(const std::string& file) { return file.empty() ? "needs the name of a file" : ""; }

void define_files(CLI::App& command, BooleanArgs& args) {
  const std::string group = "Files";
  command.add_option("A", args.a, "oriented cloud or closed mesh; - reads stdin")->required();
  command.add_option("B", args.b, "oriented cloud or closed mesh; - reads stdin")->required();
  command
      .add_option("--op", args.op,
                  "union, intersection, difference (A without B) or symmetric-difference (in exactly one)")
      ->type_name("OP")
      ->required();
  command.add_option("-o,--output", args.output, "mesh: .ply, .obj or .stl; - writes PLY to stdout")
      ->type_name("OUT")
      ->group(group)
      ->required();
  command.add_option("--cloud", args.cloud, "also write the oriented points of the result, as PLY")
      ->type_name("FILE")
      ->group(group)
      ->check(needs_a_name);
  command.add_option("--report", args.report, "write what was done as JSON")
      ->type_name("FILE")
      ->group(group)
      ->check(needs_a_name);
  command.add_option("--shift", args.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

template <class T>
CLI::Option* add_value(CLI::App& command, const std::string& name, T& value, const std::string& description) {
  return command.add_option(name, value, description)->group("Surface")->capture_default_str();
}

void define_surface(CLI::App& command, BooleanArgs& args) {
  Options& options = args.options.reconstruction;
  add_value(command, "--depth", options.depth, "octree depth D in levels, 1 to 20; cells are cube / 2^D wide")
      ->type_name("D");
  add_value(command, "--creases", args.creases, "where surfaces cross: sampled, or none")->type_name("C");
  add_value(command, "--coincidence", args.options.coincidence_cells,
            "surfaces that run alike coincide up to this distance, cells, 0 to 100")
      ->type_name("N");
  add_value(command, "--screening", options.screening, "weight of the points, no unit, >= 0; 0: unscreened")
      ->type_name("W");
  add_value(command, "--iterations", options.iterations, "relaxations per level, 1 to 1000")->type_name("N");
  add_value(command, "--scale", options.scale, "working cube / bounding cube of A and B, 1 to 100")->type_name("F");
  add_value(command, "--samples-per-node", options.samples_per_node, "points a cell should hold, 0 to 100")
      ->type_name("N");
  command.add_flag("--fixed-screening", options.fixed_screening, "weigh all points alike, however much they scatter")
      ->group("Surface");
  command.add_flag("--linear-fit", options.linear_fit, "place vertices by linear interpolation")->group("Surface");
  add_value(command, "--boundary", args.boundary,
            "field on the cube's faces: free (also called neumann), or dirichlet: 0")
      ->type_name("B");
  command.add_flag("--keep-strays", options.keep_strays, "use stray points, too, and make the cube for all points")
      ->group("Surface");
  command.add_flag("--no-normals", args.no_normals, "leave vertex normals out of the mesh")->group("Surface");
}

Creases creases_of(const std::string& word) {
  if (word == "none") return Creases::none;
  if (word == "sampled") return Creases::sampled;
  throw Error(ErrorCode::usage, fmt::format("--creases: '{}' is not none or sampled", word));
}

}  // namespace

void define_boolean_options(CLI::App& command, BooleanArgs& args) {
  define_files(command, args);
  define_surface(command, args);
  const std::string group = "Device and messages";
  command.add_option("--device", args.device, "auto, cpu, cuda or cuda:N")
      ->type_name("DEV")
      ->group(group)
      ->capture_default_str();
  add_threads_option(command, args.threads, group);
  command.add_flag("-q,--quiet", args.quiet, "errors and warnings only")->group(group);
}

BooleanOp operation_of(const std::string& word) {
  if (word == "union") return BooleanOp::unite;
  if (word == "intersection") return BooleanOp::intersect;
  if (word == "difference") return BooleanOp::subtract;
  if (word == "symmetric-difference") return BooleanOp::symmetric_difference;
  throw Error(ErrorCode::usage,
              fmt::format("--op: '{}' is not union, intersection, difference or symmetric-difference", word));
}

BooleanOptions library_options(const BooleanArgs& args) {
  BooleanOptions options = args.options;
  options.creases = creases_of(args.creases);
  options.reconstruction.normals = !args.no_normals;
  if (args.boundary == "dirichlet")
    options.reconstruction.boundary = Boundary::dirichlet;
  else if (args.boundary != "free" && args.boundary != "neumann")
    throw Error(ErrorCode::usage, fmt::format("--boundary: '{}' is not free, dirichlet or neumann", args.boundary));
  if (!(options.coincidence_cells >= 0 && options.coincidence_cells <= 100))
    throw Error(ErrorCode::usage, fmt::format("--coincidence: {} is not in [0, 100]", options.coincidence_cells));
  validate(options.reconstruction);
  return options;
}

}  // namespace pointskin::cli
