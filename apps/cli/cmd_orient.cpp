// pointskin orient: normals for clouds that have none, or wrong ones.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "normal_args.hpp"
#include "output_check.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

struct OrientArgs : DeviceArgs {
  NormalArgs normals;
  std::vector<std::string> inputs;
  std::string output, report;
  std::string shift = "auto";
  bool no_confidence = false, ascii = false, overwrite = false, quiet = false;
  GivenOptions given;
};

void check_files(const OrientArgs& args) {
  check_distinct(args.inputs, {{"-o", args.output}, {"--report", args.report, OutputKind::report}}, args.overwrite);
  check_cloud_name(args.output, "-o: {0} does not end in {1}; clouds are written as {1} only");
  check_result(args.output);
  if (!args.report.empty()) check_replaceable(args.report);
}

struct OrientTimes {
  double read_ms = 0, write_ms = 0, total_ms = 0;
};

nlohmann::ordered_json report_json(const OrientArgs& args, const NormalOptions& options, const Device& device,
                                   const Cloud& cloud, const NormalReport& report, const OrientTimes& times) {
  nlohmann::ordered_json json = {{"version", 1}, {"command", "orient"}};
  json["device"] = to_json(device);
  json["files"] = {{"inputs", args.inputs}, {"output", args.output}};
  json["input"] = {{"points", cloud.size() + cloud.dropped}, {"dropped", cloud.dropped}};
  json["options"] = to_json(options);
  json["warnings"] = printed_warnings();
  json["normals"] = to_json(report);
  json["ms"] = {{"read", times.read_ms}, {"write", times.write_ms}, {"total", times.total_ms}};
  json["memory"] = {{"host_peak_bytes", host_peak_bytes()}, {"device_peak_bytes", report.device_peak_bytes}};
  return json;
}

int run(const OrientArgs& args) {
  const Stopwatch watch;
  NormalOptions options = normal_options(args.normals, "--method");
  options.confidence = !args.no_confidence;
  const ReadOptions reading{.shift = parse_shift(args.shift), .threads = args.threads};
  check_files(args);
  const Device device = args.chosen();
  OrientTimes times;
  Cloud cloud = read_clouds(args.inputs, reading, MissingNormals::allowed);
  if (cloud.dropped > 0)
    print_warning(fmt::format("{} points were dropped: a coordinate is not finite", cloud.dropped));
  times.read_ms = watch.ms();
  on_interrupt(OnInterrupt::remember);
  const NormalReport report = estimate_normals(cloud, options, device, args.quiet);
  warn_about_unused_normals(args.given, report.method);
  throw_if_interrupted();
  const Stopwatch writing;
  write_cloud(args.output, cloud, {.ascii = args.ascii, .threads = args.threads});
  times.write_ms = writing.ms();
  times.total_ms = watch.ms();
  if (!args.report.empty())
    write_file_atomically(args.report, json_text(report_json(args, options, device, cloud, report, times)));
  if (!args.quiet)
    print_note(fmt::format("{}points {}; ms: total {:.1f}; {}", file_words(args.output), cloud.size(), times.total_ms,
                           memory_words(device, report.device_peak_bytes, host_peak_bytes())));
  return 0;
}

}  // namespace

void add_orient(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "orient", "Give a cloud normals, or correct those that it has.");
  auto args = std::make_shared<OrientArgs>();
  command->add_option("IN", args->inputs, "clouds, merged; - reads stdin")->required();
  command->add_option("-o,--output", args->output, "cloud: .ply; - writes PLY to stdout")
      ->type_name("OUT")
      ->group("Files")
      ->required()
      ->check(needs_a_name);
  command->add_option("--report", args->report, "write what was done as JSON")
      ->type_name("FILE")
      ->group("Files")
      ->check(needs_a_name);
  add_ascii_option(*command, args->ascii);
  add_overwrite_option(*command, args->overwrite);
  command->add_option("--shift", args->shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group("Files")
      ->capture_default_str();
  command
      ->add_option("--method", args->normals.method, "auto (what fits the input), sensor, propagate, iterate or repair")
      ->type_name("METHOD")
      ->group(kNormalGroup)
      ->capture_default_str();
  define_normal_options(*command, args->normals);
  command->add_flag("--curvature", args->normals.options.curvature, "add the property curvature, mean, 1 / world unit")
      ->group(kNormalGroup);
  command->add_flag("--no-confidence", args->no_confidence, "leave the property confidence out")->group(kNormalGroup);
  define_device_options(*command, *args);
  command->add_flag("-q,--quiet", args->quiet, "errors and warnings only")->group("Messages");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
