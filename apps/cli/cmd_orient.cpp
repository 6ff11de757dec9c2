// pointskin orient: normals for clouds that have none, or wrong ones.
#include <string>
#include <vector>

#include <fmt/format.h>

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
  bool ascii = false, overwrite = false, quiet = false;
  GivenOptions given;
};

OptionGroup file_options(OrientArgs& args) {
  return {"Files",
          {option("IN", "clouds, merged; - reads stdin", &args.inputs, {}, {.required = true}),
           option("-o,--output OUT", "cloud: .ply; - writes PLY to stdout", &args.output, {},
                  {.required = true, .check = needs_a_name}),
           report_row(args.report), ascii_row(args.ascii), overwrite_row(args.overwrite), shift_row(args.shift)}};
}

OptionTable orient_options(OrientArgs& args) {
  OptionGroup normals = normal_options(args.normals);
  normals.row("").spelling = "--method METHOD";
  normals.rows.front().help = "auto (what fits the input), sensor, propagate, iterate or repair";
  NormalOptions& o = args.normals.options;
  return {file_options(args).unreported(),
          normals,
          {kNormalGroup,
           {option("--curvature", "add the property curvature, mean, 1 / world unit", &o.curvature),
            option("--no-confidence", "leave the property confidence out", negated(o.confidence))}},
          device_options(args).unreported(),
          quiet_option(args.quiet)};
}

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
  OrientArgs shown = args;
  shown.normals.options = options;
  json["options"] = report_of(orient_options(shown));
  json["warnings"] = printed_warnings();
  json["normals"] = to_json(report);
  json["ms"] = {{"read", times.read_ms}, {"write", times.write_ms}, {"total", times.total_ms}};
  json["memory"] = {{"host_peak_bytes", host_peak_bytes()}, {"device_peak_bytes", report.device_peak_bytes}};
  return json;
}

int run(const OrientArgs& args) {
  const Stopwatch watch;
  const NormalOptions options = library_options(args.normals);
  const ReadOptions reading{.shift = parse_shift(args.shift), .threads = args.threads};
  check_files(args);
  const Device device = args.chosen();
  OrientTimes times;
  Cloud cloud = read_clouds(args.inputs, reading, MissingNormals::allowed);
  warn_about_dropped(cloud.dropped);
  times.read_ms = watch.ms();
  on_interrupt(OnInterrupt::remember);
  const NormalReport report = estimate_normals(cloud, options, device, args.quiet);
  warn_about_unused_normals(args.given, report.method);
  throw_if_interrupted();
  const Stopwatch writing;
  write_cloud(args.output, cloud, {.ascii = args.ascii, .threads = args.threads});
  file_was_written();
  if (args.report.empty()) ignore_interrupts();
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

Command orient_command() {
  return make_command({"orient", "Give a cloud normals, or correct those that it has."}, orient_options, run);
}

}  // namespace pointskin::cli
