#include "boolean_args.hpp"

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "commands.hpp"

namespace pointskin::cli {
namespace {

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
  add_overwrite_option(command, args.overwrite);
  command.add_option("--shift", args.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

void define_surface(CLI::App& command, BooleanArgs& args) {
  add_surface_value(command, "--creases", args.creases, "where surfaces cross: sampled, or none")->type_name("C");
  add_surface_value(command, "--coincidence", args.booleans.coincidence_cells,
                    "surfaces that run alike coincide up to this distance, cells, 0 to 100")
      ->type_name("N");
  define_solve_options(command, args.solve);
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
  define_device_options(command, args);
  command.add_flag("-q,--quiet", args.quiet, "errors and warnings only")->group("Messages");
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
  BooleanOptions options = args.booleans;
  options.creases = creases_of(args.creases);
  options.reconstruction = solve_options(args.solve);
  if (!(options.coincidence_cells >= 0 && options.coincidence_cells <= 100))
    throw Error(ErrorCode::usage, fmt::format("--coincidence: {} is not in [0, 100]", options.coincidence_cells));
  return options;
}

}  // namespace pointskin::cli
