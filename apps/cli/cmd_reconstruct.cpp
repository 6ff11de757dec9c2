// pointskin reconstruct: oriented clouds in, mesh out. pointskin problems: the same, and where to look.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "reconstruct_args.hpp"
#include "report.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {
namespace {

[[noreturn]] void throw_usage(const std::string& story) { throw Error(ErrorCode::usage, story); }

/// Everything that can be found wrong before the input is opened.
void check_files(const ReconstructArgs& args) {
  if (args.inputs.empty()) throw_usage("no input; name one or more clouds, or - for stdin");
  if (args.output.empty() && !args.dry_run && !args.repeat_given && !args.problems)
    throw_usage("no output; name it with -o");
  std::vector<std::string> inputs = args.inputs;
  if (!args.envelope.empty()) inputs.push_back(args.envelope);
  check_distinct(inputs, {{"-o", args.output}, {"--report", args.report}});
  if (!args.output.empty()) check_mesh_output(args.output);
  if (!args.report.empty()) check_replaceable(args.report);
}

/// @throws Error usage
NormalOptions normal_options_of(const ReconstructArgs& args) {
  NormalArgs normals = args.normals;
  normals.method = args.estimate_normals;
  return normal_options(normals, "--estimate-normals");
}

void warn_about_options(const ReconstructArgs& args) {
  if (args.depth_given && args.width_given) print_warning("--depth is ignored because --width chooses the depth");
}

bool makes_normals(const ReconstructArgs& args) { return !args.estimate_normals.empty(); }

/// Only what becomes part of the mesh.
void drop_attributes(const ReconstructArgs& args, Cloud& cloud) {
  if (!args.options.attributes && !args.colors) cloud.attributes.clear();
  if (!args.options.attributes && args.colors && !keep_colours_only(cloud))
    print_warning("--colors: the points have no red, green or blue");
}

/// Normals for the cloud, and then its attributes: they may say where points were seen from.
void make_normals(const ReconstructArgs& args, Record& record, Cloud& cloud) {
  NormalOptions options = normal_options_of(args);
  options.confidence = false;
  on_interrupt(OnInterrupt::remember);
  record.normals = estimate_normals(cloud, options, record.device, args.quiet);
  drop_attributes(args, cloud);
}

/// Reads, merges and cleans the input; fills in the counts.
Cloud read_input(const ReconstructArgs& args, Record& record) {
  const Stopwatch watch;
  Cloud cloud = read_clouds(args.inputs, {.shift = parse_shift(args.shift), .threads = args.threads},
                            makes_normals(args) ? MissingNormals::allowed : MissingNormals::refused);
  if (!makes_normals(args)) {
    drop_unusable(cloud);
    drop_attributes(args, cloud);
  } else if (cloud.dropped > 0) {
    print_warning(fmt::format("{} points were dropped: a coordinate is not finite", cloud.dropped));
  }
  record.read_ms = watch.ms();
  record.dropped = cloud.dropped;
  record.points = cloud.size() + cloud.dropped;
  return cloud;
}

/// Side of the working cube.
double cube_world(const Cloud& cloud, const Options& options, int threads) {
  const Bounds box = options.keep_strays ? bounds_of(cloud.positions) : find_strays(cloud.positions, threads).core;
  return options.scale * std::max({double{box.upper.x} - box.lower.x, double{box.upper.y} - box.lower.y,
                                   double{box.upper.z} - box.lower.z});
}

std::int64_t host_bytes(const Cloud& cloud) {
  std::int64_t bytes = cloud.size() * static_cast<std::int64_t>(2 * sizeof(Vec3f));
  for (const Attribute& attribute : cloud.attributes) bytes += static_cast<std::int64_t>(attribute.values.bytes());
  return bytes;
}

/// The mesh itself and what measuring distances to it takes.
std::int64_t host_bytes(const Mesh& envelope) {
  constexpr std::int64_t kTriangle = 12 + 76 + 16 + 36 + 72;  // ids, tree, its nodes, normal and neighbours; being made
  constexpr std::int64_t kVertex = 12 + 24;                   // its normal
  return kTriangle * static_cast<std::int64_t>(envelope.triangles.size()) +
         kVertex * static_cast<std::int64_t>(envelope.vertices.size());
}

/// What a run takes where the limit counts.
struct Estimate {
  std::int64_t buffers = 0;  ///< of the work; memory.device_peak_bytes of the report
  std::int64_t cloud = 0;    ///< on the CPU, the cloud and the envelope share the memory with the work

  [[nodiscard]] std::int64_t total() const { return buffers + cloud; }
};

Estimate estimate_memory(const ReconstructArgs& args, const Cloud& cloud, const Record& record) {
  const Mesh* envelope = record.options.envelope.get();
  const std::int64_t shared = host_bytes(cloud) + (envelope != nullptr ? host_bytes(*envelope) : 0);
  std::int64_t buffers = estimate_device_bytes(cloud, record.options, args.threads);
  if (makes_normals(args)) buffers = std::max(buffers, estimate_normals_device_bytes(cloud, args.threads));
  return {buffers, record.device.kind == DeviceKind::cpu ? shared : 0};
}

std::string bytes_text(std::int64_t bytes) {
  return fmt::format("{} ({} bytes)", format_bytes(static_cast<double>(bytes)), bytes);
}

void check_memory(std::int64_t estimate, std::int64_t limit) {
  if (limit == 0 || estimate <= limit) return;
  throw Error(ErrorCode::over_limit,
              fmt::format("the estimate of {} is above --max-memory {}; use a smaller --depth or allow more",
                          bytes_text(estimate), format_bytes(static_cast<double>(limit))));
}

void warn_about_strays(const Cloud& cloud, int threads) {
  const Strays strays = find_strays(cloud.positions, threads);
  if (strays.points.empty()) return;
  const Vec3f& p = cloud.positions[static_cast<std::size_t>(strays.points.front())];
  const Vec3d& origin = cloud.origin;
  print_warning(strays_text(static_cast<std::int64_t>(strays.points.size()),
                            {origin[0] + p.x, origin[1] + p.y, origin[2] + p.z}));
}

void print_estimate(const ReconstructArgs& args, const Cloud& cloud, const Record& record, const Estimate& estimate) {
  const std::string with_cloud =
      estimate.cloud > 0 ? (args.envelope.empty() ? ", with the cloud " : ", with the cloud and the envelope ") +
                               bytes_text(estimate.total())
                         : "";
  const std::string text = fmt::format("points {}, depth {}, device {}: estimate {}{}, available {}", cloud.size(),
                                       record.options.depth, record.device.name(), bytes_text(estimate.buffers),
                                       with_cloud, format_bytes(static_cast<double>(record.device.available_bytes())));
  if (args.output == "-") return print_note(text);  // stdout is kept for PLY.
  write_stdout(text + "\n");
}

/// The options of the report that the library does not know.
nlohmann::ordered_json other_options(const ReconstructArgs& args) {
  nlohmann::ordered_json json = {{"device", args.device}, {"threads", args.threads}, {"shift", args.shift}};
  json["envelope"] = or_null(args.envelope);
  if (makes_normals(args)) json["estimate_normals"] = to_json(normal_options_of(args));
  json["repeat"] = args.repeat;
  json["inputs"] = args.inputs;
  json["output"] = or_null(args.output);
  return json;
}

/// Runs the reconstruction, with progress, and the repeated runs, without.
Mesh compute(const ReconstructArgs& args, const Cloud& cloud, Record& record) {
  Reconstructor reconstructor(record.device);
  ProgressLine line(!args.quiet && stderr_is_terminal());
  Options options = record.options;
  options.max_memory_bytes = 0;  // checked before, with the cloud
  options.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  Mesh mesh = reconstructor.reconstruct(cloud, options);
  line.clear();
  record.run = reconstructor.report();
  if (record.run.strays > 0) print_warning(strays_text(record.run.strays, record.run.farthest_strays.front()));
  if (mesh.triangles.empty()) throw Error(ErrorCode::empty_result, "the surface has no triangles");
  if (args.repeat > 0) {
    options.residuals = false;  // They cost time and are not part of the job.
    options.progress = [](const Progress&) { return !interrupted(); };
    for (const RunTimes& run_times : reconstructor.repeat(cloud, options, args.repeat))
      record.repeat_ms.push_back(run_times.total_ms);
  }
  return mesh;
}

void write_output(const ReconstructArgs& args, const Mesh& mesh, Record& record) {
  throw_if_interrupted();
  if (args.output.empty()) return;
  const Stopwatch watch;
  write_mesh(args.output, mesh, args.threads);
  record.write_ms = watch.ms();
}

/// Settles what depends on the points.
void settle_options(const ReconstructArgs& args, const Cloud& cloud, Record& record) {
  Options& options = record.options;
  if (args.width_given) options.depth = depth_for_width(cube_world(cloud, options, args.threads), args.width_world);
  record.other_options = other_options(args);
}

int run(const ReconstructArgs& given) {
  const Stopwatch watch;
  ReconstructArgs args = given;
  args.inputs.insert(args.inputs.end(), args.named_inputs.begin(), args.named_inputs.end());
  Record record;
  if (args.problems) record.command = "problems";
  record.options = library_options(args);
  if (makes_normals(args)) normal_options_of(args);
  parse_shift(args.shift);
  check_files(args);
  record.device = args.chosen();
  warn_about_options(args);

  record.options.envelope = read_envelope(args.envelope, args.threads);
  Cloud cloud = read_input(args, record);
  settle_options(args, cloud, record);
  if (args.dry_run || record.options.max_memory_bytes > 0) {
    const Estimate estimate = estimate_memory(args, cloud, record);
    if (args.dry_run && !record.options.keep_strays) warn_about_strays(cloud, args.threads);
    if (args.dry_run) print_estimate(args, cloud, record, estimate);
    check_memory(estimate.total(), record.options.max_memory_bytes);
  }
  if (args.dry_run) return 0;

  if (makes_normals(args)) make_normals(args, record, cloud);
  on_interrupt(OnInterrupt::remember);
  const Mesh mesh = compute(args, cloud, record);
  cloud = Cloud();
  write_output(args, mesh, record);
  record.total_ms = watch.ms();
  record.host_peak_bytes = host_peak_bytes();

  if (record.options.weakness) record.problems = find_problems(mesh);
  record.mesh.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  if (!args.report.empty()) {
    record.mesh = measure(mesh, args.threads);
    write_file_atomically(args.report, json_text(to_json(record)));
  }
  if (args.problems && args.output == "-") print_note(problem_table(record.problems));
  if (args.problems && args.output != "-") write_stdout(problem_table(record.problems) + "\n");
  if (args.verbose) print_note(level_table(record));
  if (!args.quiet) print_note(summary(record));
  return 0;
}

}  // namespace

void add_problems(CLI::App& program, Job& job) {
  CLI::App* command =
      add_command(program, "problems", "Reconstruct, and list where the topology of the result is doubtful.");
  auto args = std::make_shared<ReconstructArgs>();
  args->problems = true;
  define_reconstruct_options(*command, *args);
  finish_command(*command, job, args, run);
}

void add_reconstruct(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "reconstruct", "Fit a watertight mesh to oriented points.");
  auto args = std::make_shared<ReconstructArgs>();
  define_reconstruct_options(*command, *args);
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
