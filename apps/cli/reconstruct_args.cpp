#include "reconstruct_args.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "args.hpp"

namespace pointskin::cli {
namespace {

OptionGroup file_options(ReconstructArgs& args) {
  OptionRow ascii = ascii_row(args.ascii);
  ascii.report = {"ascii", 63, R"({"description": "PLY was written as text"})"};
  OptionGroup group = {"Files",
                       {clouds_row(args.inputs, {}), output_row(args.output), report_row(args.report), ascii,
                        overwrite_row(args.overwrite), shift_row(args.shift)}};
  if (!args.problems)
    group.rows.insert(group.rows.begin() + 3, option("--each", "a mesh of every IN; {} in OUT: its name", &args.each));
  return group;
}

OptionGroup surface_options(ReconstructArgs& args) {
  OptionGroup group = fit_options(args);
  // What a run of its own can find out; other commands fit surfaces again and again.
  group.row("--depth").help = "octree depth D in levels, 1 to 20, or auto; cells are cube / 2^D wide";
  group.row("--trim").help = "cut where samples end: share that counts as sparse, 0 (off) to below 1, or auto";
  // A list of problems has weakness, which is defined for the field poisson alone, and for no offset.
  if (args.problems) group.without({"--field", "--offset", "--weakness"});
  return group;
}

/// A method, which also says that normals are made.
Binding estimate_by(NormalMethod& method, PointNormals& normals) {
  Binding binding = text_for("", {}, {});
  const std::string* const text = std::get<std::string*>(binding.target);
  Binding by_word = method_of(method);
  binding.settle = [by_word, text, owned = binding, &normals] {
    *std::get<std::string*>(by_word.target) = *text;
    normals = PointNormals::estimate;
    return by_word.settle();
  };
  return binding;
}

OptionGroup normals_policy(ReconstructArgs& args) {
  Options& o = args.options;
  std::vector<std::pair<std::string, PointNormals>> policies;
  for (const PointNormals policy :
       {PointNormals::given, PointNormals::automatic, PointNormals::repair, PointNormals::estimate})
    policies.emplace_back(name_of(policy), policy);
  return {kNormalGroup,
          {option("--normals WHAT", "given (as they are), auto (turned or repaired where wrong), repair, estimate",
                  one_of(o.point_normals, policies), {"point_normals", 23}),
           option("--estimate-normals{auto}",
                  "same as --normals estimate; =METHOD: auto, sensor, propagate, iterate, repair",
                  estimate_by(args.normals.options.method, o.point_normals), {}, {.excludes = "--normals"})}};
}

OptionGroup limits(ReconstructArgs& args) {
  return {kDeviceGroup,
          {option("--max-memory BYTES",
                  "what may be taken, e.g. 8G; in blocks where the whole needs more [default no limit]",
                  memory_limit(args.options.max_memory_bytes)),
           option("--temp DIR", "folder for temporary data of work in blocks [default that of the system]", &args.temp),
           option("--split", "with --max-memory: a file for each block, OUT_0000.ply, OUT_0001.ply, ...", &args.split),
           option("--dry-run", "print the memory estimate and stop", &args.dry_run)}};
}

OptionGroup messages(ReconstructArgs& args) {
  return {"Messages",
          {option("--repeat N", "run N more times on data in memory and time it", &args.repeat,
                  {"repeat", 50, kFromZero}, {.no_default = true}),
           option("-q,--quiet", "errors and warnings only", &args.quiet),
           option("-v,--verbose", "add the levels of the solve", &args.verbose, {}, {.excludes = "--quiet"})}};
}

/// Names that scripts written for PoissonRecon use.
OptionGroup poisson_recon_names(ReconstructArgs& args) {
  const auto alias = [](const std::string& spelling, Binding binding, const std::string& ours) {
    return OptionRow{spelling, "same as " + ours, std::move(binding), {}, {.no_default = true, .excludes = ours}};
  };
  Options& o = args.options;
  OptionRow type =
      alias("--bType 1|2|3",
            one_of<Boundary>(o.boundary, {{"1", Boundary::free}, {"2", Boundary::dirichlet}, {"3", Boundary::free}}),
            "--boundary");
  type.help += ": 1 free, 2 dirichlet, 3 neumann";
  type.rules.check = is_one_of({"1", "2", "3"});
  OptionRow memory = alias("--maxMemory GB", memory_limit(o.max_memory_bytes, "G"), "--max-memory");
  memory.help += ", in units of 2^30 bytes, 0: no limit";
  return {"Names of PoissonRecon",
          {alias("--iters N", &o.iterations, "--iterations"),
           option("--linearFit", "same as --linear-fit", &o.linear_fit),
           option("--in FILE", "same as IN", &args.named_inputs),
           alias("--out OUT", &args.output, "--output"),
           alias("--pointWeight W", &o.screening, "--screening"),
           alias("--samplesPerNode N", &o.samples_per_node, "--samples-per-node"),
           type,
           option("--width W", "widest finest cell, world units; chooses the depth", &args.width_world, {},
                  {.no_default = true}),
           option("--colors", "same as --keep-attributes, but for red, green and blue alone", &args.colors),
           {fmt::format("--data{{{}}}", kDataAlone), "same as --keep-attributes", &args.poisson_recon_data},
           option("--showResidual", "same as --verbose", &args.verbose, {}, {.excludes = "--quiet"}),
           memory}};
}

}  // namespace

OptionTable reconstruct_options(ReconstructArgs& args) {
  OptionGroup made_normals = normal_options(args.normals);
  made_normals.object = "estimate_normals";
  OptionTable table = {file_options(args),   surface_options(args), normals_policy(args), made_normals,
                       device_options(args), limits(args),          messages(args),       poisson_recon_names(args)};
  table.push_back(args.problems ? problem_options(args.pictures) : ignored_options());
  return table;
}

Options library_options(const ReconstructArgs& args) {
  if (args.given.has("--width") && !(args.width_world > 0 && std::isfinite(args.width_world))) {
    throw_usage(fmt::format("--width: {} is not above 0 world units", args.width_world));
  }
  if (args.given.has("--repeat") && (args.repeat < 1 || args.repeat > 1'000'000)) {
    throw_usage(fmt::format("--repeat: {} is not in [1, 1000000]", args.repeat));
  }
  Options options = args.options;
  options.normal_estimation = library_options(args.normals);
  options.attributes = options.attributes || args.colors || !args.poisson_recon_data.empty();
  options.weakness = options.weakness || args.problems;
  options.residuals = args.verbose || !args.report.empty();
  validate(options);
  return options;
}

int depth_for_width(double cube_world, double width_world) {
  constexpr int kDeepest = 20;
  int depth = 1;
  while (depth < kDeepest && std::ldexp(cube_world, -depth) > width_world) ++depth;
  if (std::ldexp(cube_world, -depth) <= width_world) return depth;
  throw_usage(
      fmt::format("--width: cells of {} need more than {} levels in a cube of {}", width_world, kDeepest, cube_world));
}

}  // namespace pointskin::cli
