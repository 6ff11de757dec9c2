#include "reconstruct_blocks.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/scale.hpp>

#include "args.hpp"
#include "console.hpp"
#include "input.hpp"
#include "progress.hpp"
#include "ranks.hpp"
#include "run_memory.hpp"
#include "signals.hpp"
#include "spooled_input.hpp"
#include "summary_words.hpp"

namespace pointskin::cli {
namespace {

constexpr int kShallowest = 7;  // that reconstruct_files() takes

bool keeps_colours_alone(const ReconstructArgs& args) {
  return args.colors && !args.options.attributes && args.poisson_recon_data.empty();
}

/// What is asked for and blocks do not do; an envelope also where it has not been read.
std::vector<std::string> missing(const ReconstructArgs& args, const Options& options) {
  ScaleOptions scale;
  scale.only_colours = keeps_colours_alone(args);
  std::vector<std::string> names = missing_in_blocks(args.inputs, options, scale);
  if (!args.envelope.empty() && options.envelope == nullptr) names.emplace_back("an envelope");
  return names;
}

void refuse_what_is_missing(const ReconstructArgs& args, const Options& options) {
  const std::vector<std::string> names = missing(args, options);
  if (names.empty()) return;
  const std::string why = is_one_of_ranks()
                              ? "several ranks work in blocks, and there"
                              : fmt::format("the whole needs more than --max-memory {}, and in blocks there",
                                            format_bytes(static_cast<double>(options.max_memory_bytes)));
  throw Error(ErrorCode::usage, fmt::format("{} is not yet: {}", why, fmt::join(names, ", ")));
}

/// Of a GPU a limit counts what lies on it; else the process.
std::int64_t bytes_for_work(const ReconstructArgs& args, const Device& device) {
  const std::int64_t limit = args.options.max_memory_bytes;
  return device.kind == DeviceKind::cpu && limit > 0 ? bytes_left_of(limit) : limit;
}

ScaleOptions scale_options(const ReconstructArgs& args, const Device& device) {
  ScaleOptions scale;
  scale.max_memory_bytes = bytes_for_work(args, device);
  scale.device = device;
  scale.threads = args.threads;
  scale.shift = parse_shift(args.shift);
  scale.temp_folder = args.temp;
  scale.split = args.split;
  scale.only_colours = keeps_colours_alone(args);
  scale.ranks = launched_ranks();
  return scale;
}

/// Calls work(). @throws Error as it does; of too little memory, with what the program takes beside it
template <class Work>
auto within_limit(const ReconstructArgs& args, const ScaleOptions& scale, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::over_limit) throw;
    const std::int64_t limit = args.options.max_memory_bytes;
    if (scale.device.kind != DeviceKind::cpu)
      throw Error(ErrorCode::over_limit, fmt::format("--max-memory {}: {}", bytes_text(limit), error.what()));
    throw Error(ErrorCode::over_limit,
                fmt::format("--max-memory {}, of which the program takes {}: {}", bytes_text(limit),
                            bytes_text(limit - scale.max_memory_bytes), error.what()));
  }
}

/// On the mesh, or with a warning why not.
bool has_colours(const FilesReport& files) {
  const std::vector<Warning>& warnings = files.run.warnings;
  return !files.attributes.empty() || std::any_of(warnings.begin(), warnings.end(), [](const Warning& warning) {
    return warning.kind == WarningKind::attributes_missing;
  });
}

void warn_about_left_out(const FilesReport& files) {
  warn_about_dropped(files.dropped);
  warn_about_zero_normals(files.without_normal);
}

/// From files that can be read in parts, or one pipe, to binary PLY.
bool suits_blocks(const ReconstructArgs& args) {
  if (args.each || args.repeat > 0 || args.problems) return false;
  if (args.options.depth != Options::kAutomaticDepth && args.options.depth < kShallowest) return false;
  const bool to_ply = !args.ascii && (std::filesystem::path(args.output).extension() == ".ply" ||
                                      (args.dry_run && args.output.empty()));
  if (!to_ply || args.given.has("--width")) return false;
  return comes_through_pipe(args) || std::all_of(args.inputs.begin(), args.inputs.end(), reads_in_parts);
}

}  // namespace

bool comes_through_pipe(const ReconstructArgs& args) {
  return !is_one_of_ranks() && args.inputs.size() == 1 && is_pipe(args.inputs.front());
}

bool may_work_in_blocks(const ReconstructArgs& args) { return args.options.max_memory_bytes > 0 && suits_blocks(args); }

void check_ranks(const ReconstructArgs& args) {
  if (!suits_blocks(args))
    throw_usage(fmt::format(
        "several ranks reconstruct files of text, binary PLY or NPY to a binary .ply file, with a --depth of at "
        "least {}; not with "
        "--each, --repeat or --width",
        kShallowest));
}

Device device_of_rank(const ReconstructArgs& args) {
  const bool open = args.device == "auto" || args.device == "cuda";
  Device device = args.chosen();
  if (device.kind == DeviceKind::cpu) return device;
  const std::vector<int> gpus = (open ? parse_device("cuda:all", args.threads) : device).gpus();
  return Device::cuda(gpus[static_cast<std::size_t>(launched_ranks()->rank_on_host()) % gpus.size()]);
}

bool must_work_in_blocks(const ReconstructArgs& args, const Options& options, const Device& device) {
  if (args.split) return true;
  if (!missing(args, options).empty()) return false;
  std::int64_t bytes = 0;
  for (const std::string& input : args.inputs) {
    std::error_code error;
    const auto size = std::filesystem::file_size(input == "-" ? "/dev/stdin" : input, error);
    if (!error) bytes += static_cast<std::int64_t>(size);
  }
  return bytes > bytes_for_work(args, device) / 2;
}

void print_plan(const ReconstructArgs& args, const Record& record) {
  refuse_what_is_missing(args, record.options);
  const ScaleOptions scale = scale_options(args, record.device);
  const FilesPlan plan = within_limit(args, scale, [&] { return plan_files(args.inputs, record.options, scale); });
  const std::string text = fmt::format(
      "points {}, depth {}, device {}: in {}, each with {} cells of level {} around it, "
      "{:.2f} times the octree's nodes in all; {} passes; estimate {}, temporary data {}",
      plan.points, record.options.depth, record.device.name(), counted(plan.blocks, "block"), plan.ring,
      plan.coarse_level, plan.overlap, plan.passes, bytes_text(plan.memory_bytes), bytes_text(plan.temp_bytes));
  if (args.output == "-") return print_note(text);  // stdout is kept for PLY
  write_stdout(text + "\n");
}

void reconstruct_in_blocks(const ReconstructArgs& args, const Stopwatch& watch, Record& record) {
  refuse_what_is_missing(args, record.options);
#ifdef __GLIBC__
  malloc_trim(0);  // what the whole left behind
#endif
  on_interrupt(OnInterrupt::remember);
  ProgressLine line(!args.quiet && tells_for_all() && stderr_is_terminal());
  Options options = record.options;
  options.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  const bool was_said = record.points > 0;
  const ScaleOptions scale = scale_options(args, record.device);
  const FilesReport files =
      within_limit(args, scale, [&] { return reconstruct_files(args.inputs, args.output, options, scale); });
  line.clear();
  file_was_written();
  if (!was_said) {
    warn_about_left_out(files);
    if (scale.only_colours && !has_colours(files)) warn_about_no_colours();
  }
  for (const Warning& warning : files.run.warnings)
    if (warning.kind != WarningKind::coarse_depth || !args.given.has("--depth")) print_warning(warning.text);
  record.run = files.run;
  record.blocks = files.blocks;
  record.coarse_level = files.coarse_level;
  record.dropped = files.dropped + files.without_normal;
  record.points = files.run.points + files.run.strays + record.dropped;
  record.mesh.triangles = files.triangles;
  record.shape = counted(files.blocks, "block");
  if (args.split) record.shape += " in " + counted(std::ssize(files.outputs), "file");
  record.total_ms = watch.ms();
  record.host_peak_bytes = host_peak_bytes();
  if (args.report.empty() || !tells_for_all()) return;
  record.mesh = measure_file(args.output, {.max_memory_bytes = scale.max_memory_bytes, .threads = args.threads});
  record.shape = fmt::format("{}; {}", shape_words(record.mesh), counted(files.blocks, "block"));
}

}  // namespace pointskin::cli
