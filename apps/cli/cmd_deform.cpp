// pointskin deform: a cloud bent by handles and lattices, frame after frame.
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "deform_reach.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "scene/deform_script.hpp"
#include "scene/frame_files.hpp"
#include "signals.hpp"
#include "statistics.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct DeformArgs : FitArgs, DeviceArgs {
  std::vector<std::string> inputs;
  std::string script, output, cloud, report;  ///< empty: none
  std::string shift = "auto";
  int frames = 1;
  bool overwrite = false, quiet = false;
  GivenOptions given;
};

OptionGroup file_options(DeformArgs& args) {
  return {
      "Files",
      {clouds_row(args.inputs),
       option("--script FILE", "the deformation as JSON; - reads stdin", &args.script, {"script", 61, kNeverNull},
              {.required = true}),
       output_row(args.output),
       option("--cloud OUT", "deformed points: .ply, - writes to stdout", &args.cloud, {"cloud", 63}),
       option("--report FILE", "write what was done as JSON; also measures how far apart samples are", &args.report),
       overwrite_row(args.overwrite), shift_row(args.shift),
       option("--frames N", "N frames from the rest pose to the deformation; {} in OUT: number", &args.frames,
              {"frames", 50, kFromOne}, {.no_default = true})}};
}

OptionTable deform_options(DeformArgs& args) {
  return {file_options(args), fit_options(args), device_options(args), memory_options(args.options.max_memory_bytes),
          quiet_option(args.quiet)};
}

std::string file_of(const DeformArgs& args, const std::string& pattern, int frame) {
  return args.given.has("--frames") ? scene::frame_file(pattern, frame, args.frames) : pattern;
}

/// With --frames, a file a frame.
void check_names(const DeformArgs& args) {
  FilePlan plan{{{args.script}}, {{"--report", args.report, OutputKind::report}}, args.overwrite};
  if (!args.envelope.empty()) plan.inputs.push_back({args.envelope});
  for (const std::string& input : args.inputs) plan.inputs.push_back({input});
  const std::vector<OutputFile> patterns = {{"-o", args.output}, {"--cloud", args.cloud}};
  for (const OutputFile& pattern : patterns) {
    for (int frame = 0; frame < args.frames && !pattern.file.empty(); ++frame)
      plan.outputs.push_back({pattern.option, file_of(args, pattern.file, frame), pattern.kind,
                              args.given.has("--frames") ? frame : kNoFrame});
  }
  check_files(plan);
}

/// Everything that can be found wrong before the input is opened.
void check_outputs(const DeformArgs& args) {
  if (args.output.empty() && args.cloud.empty()) throw_usage("no output; name a mesh with -o or a cloud with --cloud");
  if (args.given.has("--frames") && (args.frames < 2 || args.frames > 100'000))
    throw_usage(fmt::format("--frames: {} is not in [2, 100000]", args.frames));
  if (args.given.has("--frames")) {
    scene::check_pattern(args.output, "-o", "--frames");
    scene::check_pattern(args.cloud, "--cloud", "--frames");
  }
  check_names(args);
  if (!args.output.empty()) check_mesh_output(file_of(args, args.output, 0));
  if (!args.cloud.empty()) {
    check_cloud_name(args.cloud, "--cloud: {}: clouds are written as {} only");
    check_result(file_of(args, args.cloud, 0));
  }
  if (!args.report.empty()) check_replaceable(args.report);
}

/// The script, checked against the cloud.
Deformation checked(const DeformArgs& args, Deformation deformation, std::int64_t points) {
  try {
    validate(deformation, points);
  } catch (const Error& error) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: {}", args.script, error.what()));
  }
  return deformation;
}

/// Deforms, writes and measures one frame after another.
class DeformedFrames {
 public:
  DeformedFrames(const DeformArgs& args, Deformer& deformer, const Deformation& deformation)
      : args_(args), deformer_(deformer), deformation_(deformation) {}

  void run_all() {
    for (int frame = 0; frame < args_.frames; ++frame) run_one(frame);
  }

  [[nodiscard]] const Json& json() const { return json_; }
  [[nodiscard]] double median_ms() const { return spread_of(frame_ms_).median; }
  /// Of the last frame; empty without meshes.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

 private:
  void run_one(int frame) {
    throw_if_interrupted();
    const double share = is_sequence() ? static_cast<double>(frame) / (args_.frames - 1) : 1;
    const Stopwatch watch;
    deformer_.deform(scaled(deformation_, share));
    if (!args_.output.empty()) deformer_.reconstruct(mesh_);
    frame_ms_.push_back(watch.ms());
    const Stopwatch writing;
    throw_if_interrupted();
    write_frame(frame);
    if (is_sequence()) frame_was_written();
    if (!args_.report.empty()) json_.push_back(describe(share, frame_ms_.back(), writing.ms()));
  }

  void write_frame(int frame) const {
    if (!args_.output.empty()) write_mesh(file_of(args_, args_.output, frame), mesh_, args_.threads);
    if (!args_.output.empty() && !is_sequence()) file_was_written();
    if (args_.cloud.empty()) return;
    std::optional<UndisturbedScope> whole;  // a frame is both of its files
    if (!args_.output.empty()) whole.emplace();
    write_cloud(file_of(args_, args_.cloud, frame), deformer_.cloud(), args_.threads);
    if (!is_sequence()) file_was_written();
  }

  [[nodiscard]] bool is_sequence() const { return args_.given.has("--frames"); }

  [[nodiscard]] Json describe(double share, double total_ms, double write_ms) const {
    const DeformReport& report = deformer_.report();
    const SpacingRatios spacing = deformer_.spacing();
    Json json = {{"share", share},
                 {"points", report.points},
                 {"inserted", report.inserted},
                 {"thinned", report.thinned},
                 {"spacing", {{"p05", spacing.p05}, {"median", spacing.median}, {"p95", spacing.p95}}}};
    if (!args_.output.empty()) json["mesh"] = to_json(measure(mesh_, args_.threads));
    json["ms"] = {{"sample", report.sample_ms}, {"map", report.map_ms}};
    if (!args_.output.empty()) json["ms"]["mesh"] = report.mesh_ms;
    json["ms"]["total"] = total_ms;
    json["ms"]["write"] = write_ms;
    return json;
  }

  const DeformArgs& args_;
  Deformer& deformer_;
  const Deformation& deformation_;
  Mesh mesh_;
  std::vector<double> frame_ms_;
  Json json_ = Json::array();
};

/// Options that come to nothing, and parts of the script.
void warn_about_unused(const DeformArgs& args, const Options& options, const Deformation& deformation,
                       const Cloud& cloud) {
  warn_about_unused(args.given, options, args.output, false);
  warn_about_unused(args.given, options, cloud, args.output);
  if (args.output.empty())
    warn_unused(args.given,
                {"--linear-fit", "--open", "--envelope", "--offset", "--trim", "--island-ratio", "--weakness",
                 "--no-normals", "--density", "--keep-attributes"},
                kNoMesh);
  if (!moves_anything(deformation)) print_warning(fmt::format("{}: moves nothing", args.script));
  for (const std::string& story : idle_parts(deformation, cloud))
    print_warning(fmt::format("{}: {}", args.script, story));
}

/// The last line.
std::string deform_summary(const DeformArgs& args, const DeformReport& report, const DeformedFrames& frames) {
  const std::string mesh = args.output.empty() ? ""
                                               : fmt::format("; triangles {}, {}", frames.mesh().triangles.size(),
                                                             shape_words(frames.mesh(), args.threads));
  return fmt::format(
      "{}points {}, of them inserted {}, thinned {}{}; {}: median {:.1f} ms, {:.1f} frames per second; memory {} host",
      file_words(args.output.empty() ? args.cloud : args.output), report.points, report.inserted, report.thinned, mesh,
      counted(args.frames, "frame"), frames.median_ms(), 1000 / frames.median_ms(),
      format_bytes(static_cast<double>(host_peak_bytes())));
}

int run(const DeformArgs& args) {
  Options options = args.options;
  validate(options);
  parse_shift(args.shift);
  check_outputs(args);
  const Device device = args.chosen();
  Deformation deformation = scene::read_deformation(args.script);
  const Stopwatch reading;
  options.envelope = read_envelope(args.envelope, args.threads);
  Cloud cloud = read_clouds(args.inputs, {.shift = parse_shift(args.shift), .threads = args.threads});
  drop_unusable(cloud);
  const double read_ms = reading.ms();
  deformation = checked(args, std::move(deformation), cloud.size());
  warn_about_unused(args, options, deformation, cloud);

  on_interrupt(OnInterrupt::remember);
  options.progress = [](const Progress&) { return !interrupted(); };
  const RunMemory memory(device, options, options.max_memory_bytes);
  memory.check(cloud);
  options.max_memory_bytes = memory.limit_of_run();
  const Workspace workspace(device);
  memory.limit(workspace);
  Deformer deformer = memory.within_limit([&] { return Deformer(cloud, options, workspace); });
  const RunReport& at_rest = deformer.report().run;
  if (at_rest.strays > 0) print_warning(strays_text(at_rest.strays, at_rest.farthest_strays.front()));
  Json json = {{"version", 1}, {"command", "deform"}};
  json["device"] = to_json(device);
  json["input"] = {{"points", cloud.size() + cloud.dropped},
                   {"used", deformer.report().rest_points},
                   {"dropped", cloud.dropped},
                   {"strays", at_rest.strays}};
  json["options"] = report_of(deform_options, args);
  cloud = Cloud();

  DeformedFrames frames(args, deformer, deformation);
  memory.within_limit([&] { frames.run_all(); });
  const DeformReport& report = deformer.report();
  json["frames"] = frames.json();
  json["ms"] = {
      {"read", read_ms}, {"upload", report.upload_ms}, {"rest", report.rest_ms}, {"frame_median", frames.median_ms()}};
  if (!args.report.empty()) write_file_atomically(args.report, json_text(json));
  warn_about_envelope(report.run.envelope, report.run.points);
  if (!args.quiet) print_note(deform_summary(args, report, frames));
  return 0;
}

}  // namespace

Command deform_command() {
  return make_command({"deform", "Bend a cloud by handles and lattices, and fit meshes to it."}, deform_options, run);
}

}  // namespace pointskin::cli
