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
      ->check(needs_a_name);
  add_ascii_option(command, args.ascii);
  add_overwrite_option(command, args.overwrite);
  command.add_option("--shift", args.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

/// What a run of its own can find out; other commands fit surfaces again and again.
void describe_automatic_values(CLI::App& command) {
  command.get_option("--depth")->description("octree depth D in levels, 1 to 20, or auto; cells are cube / 2^D wide");
  command.get_option("--trim")->description(
      "cut where samples end: share that counts as sparse, 0 (off) to below 1, or auto");
}

void define_normals(CLI::App& command, ReconstructArgs& args) {
  CLI::Option* policy = command
                            .add_option("--normals", args.normals_policy,
                                        "given (as they are), auto (turned or repaired where wrong), repair, estimate")
                            ->type_name("WHAT")
                            ->group(kNormalGroup)
                            ->capture_default_str();
  command
      .add_flag("--estimate-normals{auto}", args.estimate_normals,
                "same as --normals estimate; =METHOD: auto, sensor, propagate, iterate, repair")
      ->group(kNormalGroup)
      ->excludes(policy);
  define_normal_options(command, args.normals);
}

void define_limits(CLI::App& command, ReconstructArgs& args) {
  const std::string group = kDeviceGroup;
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
  alias("--iters", args.options.iterations, "--iterations", "N");
  command.add_flag("--linearFit", args.options.linear_fit, "same as --linear-fit")->group(group);
  command.add_option("--in", args.named_inputs, "same as IN")->type_name("FILE")->group(group)->allow_extra_args(false);
  alias("--out", args.output, "--output", "OUT");
  alias("--pointWeight", args.options.screening, "--screening", "W");
  alias("--samplesPerNode", args.options.samples_per_node, "--samples-per-node", "N");
  command.add_option("--bType", args.boundary_type, "same as --boundary: 1 free, 2 dirichlet, 3 neumann")
      ->type_name("1|2|3")
      ->group(group)
      ->excludes(command.get_option("--boundary"))
      ->check(is_one_of({"1", "2", "3"}));
  command.add_option("--width", args.width_world, "widest finest cell, world units; chooses the depth")
      ->type_name("W")
      ->group(group)
      ->each([&args](const std::string&) { args.width_given = true; });
  command.add_flag("--colors", args.colors, "same as --keep-attributes, but for red, green and blue alone")
      ->group(group);
  command.add_flag(fmt::format("--data{{{}}}", kDataAlone), args.poisson_recon.data, "same as --keep-attributes")
      ->group(group);
  command.add_flag("--showResidual", args.verbose, "same as --verbose")
      ->group(group)
      ->excludes(command.get_option("--quiet"));
  command.add_option("--maxMemory", "same as --max-memory, in units of 2^30 bytes, 0: no limit")
      ->type_name("GB")
      ->group(group)
      ->excludes(command.get_option("--max-memory"))
      ->each([&args](const std::string& gb) { args.max_memory = parse_number(gb) == 0 ? "" : gb + "G"; });
  if (!args.problems) define_ignored_options(command, args.poisson_recon);
}

PointNormals point_normals_of(const ReconstructArgs& args) {
  if (!args.estimate_normals.empty()) return PointNormals::estimate;
  for (const PointNormals policy :
       {PointNormals::given, PointNormals::automatic, PointNormals::repair, PointNormals::estimate})
    if (args.normals_policy == name_of(policy)) return policy;
  throw Error(ErrorCode::usage,
              fmt::format("--normals: '{}' is not given, auto, repair or estimate", args.normals_policy));
}

/// @throws Error usage
NormalOptions normal_estimation_of(const ReconstructArgs& args) {
  NormalArgs normals = args.normals;
  if (!args.estimate_normals.empty()) normals.method = args.estimate_normals;
  return normal_options(normals, "--estimate-normals");
}

}  // namespace

void define_reconstruct_options(CLI::App& command, ReconstructArgs& args) {
  define_files(command, args);
  define_fit_options(command, args);
  describe_automatic_values(command);
  define_normals(command, args);
  define_device_options(command, args);
  define_limits(command, args);
  define_messages(command, args);
  define_poisson_recon_names(command, args);
  if (!args.problems) return;
  // A list of problems has weakness, which is defined for the field poisson alone, and for no offset.
  for (const char* const name : {"--field", "--offset", "--weakness"}) command.remove_option(command.get_option(name));
}

Options library_options(const ReconstructArgs& args) {
  if (args.width_given && !(args.width_world > 0 && std::isfinite(args.width_world))) {
    throw Error(ErrorCode::usage, fmt::format("--width: {} is not above 0 world units", args.width_world));
  }
  if (args.repeat_given && (args.repeat < 1 || args.repeat > 1'000'000)) {
    throw Error(ErrorCode::usage, fmt::format("--repeat: {} is not in [1, 1000000]", args.repeat));
  }
  Options options = fit_options(args);
  if (args.boundary_type != 0) options.boundary = args.boundary_type == 2 ? Boundary::dirichlet : Boundary::free;
  options.point_normals = point_normals_of(args);
  options.normal_estimation = normal_estimation_of(args);
  options.attributes = options.attributes || args.colors || !args.poisson_recon.data.empty();
  options.weakness = options.weakness || args.problems;
  options.residuals = args.verbose || !args.report.empty();
  if (!args.max_memory.empty()) options.max_memory_bytes = parse_bytes(args.max_memory, "--max-memory");
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
