#include "reconstruct_run.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/suggest_device.hpp>

#include "args.hpp"
#include "console.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "progress.hpp"
#include "ranks.hpp"
#include "reconstruct_blocks.hpp"
#include "resident_runs.hpp"
#include "run_memory.hpp"
#include "run_mesh.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

/// Points without a normal get one.
bool makes_normals(const Options& options) {
  return options.point_normals == PointNormals::repair || options.point_normals == PointNormals::estimate;
}

/// Only what becomes part of the mesh, or says where points were seen from.
void drop_attributes(const ReconstructArgs& args, Cloud& cloud) {
  const bool all = args.options.attributes || !args.poisson_recon_data.empty();
  const bool tells_views = args.options.point_normals != PointNormals::given && has_view_attributes(cloud);
  if (!all && !args.colors && !tells_views) cloud.attributes.clear();
  if (!all && args.colors && !keep_colours_only(cloud)) warn_about_no_colours();
}

/// Reads, merges and cleans the input; fills in the counts.
Cloud read_input(const ReconstructArgs& args, Record& record) {
  const Stopwatch watch;
  Cloud cloud = read_clouds(args.inputs, {.shift = parse_shift(args.shift), .threads = args.threads},
                            makes_normals(record.options) ? MissingNormals::allowed : MissingNormals::refused);
  if (makes_normals(record.options))
    warn_about_dropped(cloud.dropped);
  else
    drop_unusable(cloud);
  drop_attributes(args, cloud);
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

void print_estimate(const ReconstructArgs& args, const Cloud& cloud, const Record& record,
                    const MemoryEstimate& estimate) {
  const std::string together =
      estimate.beside > 0 ? fmt::format(", with the cloud{} and the program {}",
                                        args.envelope.empty() ? "" : ", the envelope", bytes_text(estimate.total()))
                          : "";
  const std::string text = fmt::format("points {}, depth {}, device {}: estimate {}{}, available {}", cloud.size(),
                                       record.options.depth, record.device.name(), bytes_text(estimate.buffers),
                                       together, format_bytes(static_cast<double>(record.device.available_bytes())));
  if (args.output == "-") return print_note(text);  // stdout is kept for PLY.
  write_stdout(text + "\n");
}

/// The options of the report, after the run.
nlohmann::ordered_json shown_options(const ReconstructArgs& args, const Record& record) {
  ReconstructArgs shown = args;
  if (args.asked) static_cast<DeviceArgs&>(shown) = *args.asked;
  shown.options = record.options;
  if (record.options.trim == Options::kAutomaticTrim) shown.options.trim = record.run.trim.quantile;
  shown.normals.options = record.options.normal_estimation;
  nlohmann::ordered_json json = report_of(reconstruct_options(shown));
  if (!makes_normals(record.options)) json.erase("estimate_normals");
  return json;
}

/// The depth is what was asked for: nothing needs to be said of it.
bool chose_depth(const ReconstructArgs& args) { return args.given.has("--depth") || args.given.has("--width"); }

/// Options of the normals, where the run kept those that were given or made its own in another way.
void warn_about_unused_normals(const ReconstructArgs& args, const RunReport& run) {
  if (run.normals) return warn_about_unused_normals(args.given, run.normals->method);
  if (args.options.point_normals != PointNormals::given) warn_about_unused_normals(args.given);
}

/// Runs the reconstruction, with progress, and the repeated runs, without.
RunMesh compute(const ReconstructArgs& args, const Cloud& cloud, const RunMemory& memory, Reconstructor& reconstructor,
                Record& record) {
  ProgressLine line(!args.quiet && stderr_is_terminal());
  Options options = record.options;
  options.max_memory_bytes = memory.limit_of_run();
  options.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  RunMesh mesh(reconstructor.workspace());
  memory.within_limit([&] { mesh.make(reconstructor, cloud, options); });
  line.clear();
  record.run = reconstructor.report();
  for (const Warning& warning : record.run.warnings)
    if (warning.kind != WarningKind::coarse_depth || !chose_depth(args)) print_warning(warning.text);
  if (record.run.normals) warn_about_unsettled(*record.run.normals);
  if (record.run.normals && !args.quiet) print_note(summary(*record.run.normals));
  warn_about_unused_normals(args, record.run);
  warn_about_envelope(record.run.envelope, record.run.points);
  if (mesh.triangles() == 0) throw Error(ErrorCode::empty_result, "the surface has no triangles");
  if (args.repeat > 0) {
    options.residuals = false;  // They cost time and are not part of the job.
    options.progress = [](const Progress&) { return !interrupted(); };
    for (const ResidentRun& resident : run_resident(reconstructor, cloud, options, args.repeat))
      record.repeat_ms.push_back(resident.total_ms);
  }
  return mesh;
}

void write_output(const ReconstructArgs& args, const RunMesh& mesh, Record& record) {
  throw_if_interrupted();
  if (args.output.empty()) return;
  const Stopwatch watch;
  mesh.write(args.output, {.ascii = args.ascii, .threads = args.threads});
  file_was_written();
  if (!args.each && args.report.empty() && args.pictures.folder.empty()) ignore_interrupts();
  record.write_ms = watch.ms();
}

/// The deepest that the points support and the memory holds.
int choose_depth(const ReconstructArgs& args, const Cloud& cloud, const RunMemory& memory, const Record& record) {
  Options options = record.options;
  options.max_memory_bytes = memory.limit_of_run();
  const DepthSuggestion chosen = memory.within_limit([&] { return suggest_depth(cloud, options, record.device); });
  if (chosen.depth < chosen.supported)
    print_warning(fmt::format("the memory holds depth {} only; the points hold detail for depth {}", chosen.depth,
                              chosen.supported));
  if (!args.quiet)
    print_note(
        fmt::format("depth {}: the points lie {:.3g} apart, noise {:.3g}", chosen.depth, chosen.spacing, chosen.noise));
  return chosen.depth;
}

/// The device that is done first.
Device choose_device(const ReconstructArgs& args, const Cloud& cloud, Options options) {
  if (!built_with_cuda()) return Device::cpu(args.threads);
  if (args.given.has("--width"))
    options.depth = depth_for_width(cube_world(cloud, options, args.threads), args.width_world);
  return suggest_device(cloud, options, args.threads);
}

/// Settles what depends on the points.
void settle_options(const ReconstructArgs& args, const Cloud& cloud, const RunMemory& memory, Record& record) {
  Options& options = record.options;
  if (args.given.has("--width"))
    options.depth = depth_for_width(cube_world(cloud, options, args.threads), args.width_world);
  else if (options.depth == Options::kAutomaticDepth)
    options.depth = choose_depth(args, cloud, memory, record);
}

/// @param record  with the options; receives all else
void run_whole(const ReconstructArgs& args, const Stopwatch& watch, std::unique_ptr<Reconstructor>& reconstructor,
               Record& record) {
  // Repeated runs pay no start; what a limit counts depends on the device.
  const bool open = args.leaves_device_open() && args.repeat == 0 && record.options.max_memory_bytes == 0;
  if (!open) record.device = args.chosen();

  if (record.options.envelope == nullptr) record.options.envelope = read_envelope(args.envelope, args.threads);
  Cloud cloud = read_input(args, record);
  if (open) record.device = choose_device(args, cloud, record.options);
  const bool counts = args.dry_run || record.options.max_memory_bytes > 0;
  const RunMemory memory =
      counts ? RunMemory(record.device, record.options, record.options.max_memory_bytes) : RunMemory();
  memory.check(cloud);
  settle_options(args, cloud, memory, record);
  if (args.dry_run && !record.options.keep_strays) warn_about_strays(cloud, args.threads);
  if (args.dry_run) {
    const MemoryEstimate estimate = memory.estimate(cloud, record.options);
    print_estimate(args, cloud, record, estimate);
    memory.check(estimate);
  }
  if (args.dry_run) return;

  on_interrupt(OnInterrupt::remember);
  warn_about_unused(args.given, record.options, cloud, mesh_file(args));
  if (!reconstructor) reconstructor = std::make_unique<Reconstructor>(record.device);
  RunMesh mesh = compute(args, cloud, memory, *reconstructor, record);
  cloud = Cloud();
  write_output(args, mesh, record);
  record.total_ms = watch.ms();
  record.host_peak_bytes = host_peak_bytes();
  // What looks at the mesh takes memory of its own, in place of that of the run.
  if (!args.each && record.device.kind == DeviceKind::cpu) reconstructor->workspace().release_memory();

  if (record.options.weakness)
    record.problems = find_problems(mesh.on_host(), problem_options(args.pictures, args.threads));
  if (!args.pictures.folder.empty())
    record.pictures = write_problem_pictures(mesh.on_host(), record.problems, args.pictures, args.threads, !args.quiet);
  record.mesh.triangles = mesh.triangles();
  if (!args.report.empty()) record.mesh = measure(mesh.on_host(), args.threads);
  if (!args.quiet)
    record.shape = args.report.empty() ? shape_words(mesh.glance(args.threads)) : shape_words(record.mesh);
}

/// @returns false if the whole needs more than --max-memory
bool run_whole_if_it_fits(const ReconstructArgs& args, const Stopwatch& watch,
                          std::unique_ptr<Reconstructor>& reconstructor, Record& record) {
  if (must_work_in_blocks(args, record.options, record.device)) return false;
  try {
    run_whole(args, watch, reconstructor, record);
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::over_limit) throw;
    return false;
  }
}

void run_in_blocks(const ReconstructArgs& args, const Stopwatch& watch, Record& record) {
  if (args.dry_run) return print_plan(args, record);
  reconstruct_in_blocks(args, watch, record);
}

/// The whole, or blocks where it does not fit. Several ranks work in blocks.
void run_within_limit(const ReconstructArgs& args, const Stopwatch& watch,
                      std::unique_ptr<Reconstructor>& reconstructor, Record& record) {
  if (is_one_of_ranks()) {
    record.device = device_of_rank(args);
    return run_in_blocks(args, watch, record);
  }
  if (record.options.max_memory_bytes > 0) record.device = args.chosen();
  if (!may_work_in_blocks(args)) return run_whole(args, watch, reconstructor, record);
  if (run_whole_if_it_fits(args, watch, reconstructor, record)) return;
  reconstructor.reset();
  run_in_blocks(args, watch, record);
}

}  // namespace

std::string mesh_file(const ReconstructArgs& args) {
  return args.output.empty() && (args.dry_run || args.given.has("--repeat")) ? "-" : args.output;
}

Record run_reconstruction(const ReconstructArgs& args, const Stopwatch& watch,
                          std::unique_ptr<Reconstructor>& reconstructor) {
  Record record;
  if (args.problems) record.command = "problems";
  record.options = library_options(args);
  run_within_limit(args, watch, reconstructor, record);
  if (args.dry_run) return record;
  if (!args.report.empty()) record.shown_options = shown_options(args, record);
  if (!tells_for_all()) return record;
  if (!args.report.empty()) write_file_atomically(args.report, json_text(to_json(record)));
  if (!args.report.empty() && args.each) file_was_written();
  return record;
}

}  // namespace pointskin::cli
