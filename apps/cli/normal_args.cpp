#include "normal_args.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "console.hpp"
#include "progress.hpp"
#include "signals.hpp"

namespace pointskin::cli {

using Json = nlohmann::ordered_json;

void define_normal_options(CLI::App& command, NormalArgs& args) {
  NormalOptions& options = args.options;
  const auto value = [&](const std::string& name, auto& target, const std::string& description) {
    return command.add_option(name, target, description)->group(kNormalGroup)->capture_default_str();
  };
  command
      .add_option("--sensor", args.sensors,
                  "where a scanner stood, world coordinates; may be repeated, the nearest saw a point")
      ->type_name("X,Y,Z")
      ->group(kNormalGroup)
      ->allow_extra_args(false);
  value("--keep-within", options.keep_within_degrees, "repair: largest angle of a normal that stays, degrees, 0 to 90")
      ->type_name("A");
  value("--max-rounds", options.max_rounds, "trial reconstructions at most, 1 to 1000")->type_name("N");
  value("--time-limit", options.time_limit_s, "begin no further trial after so many seconds, 0: no limit")
      ->type_name("S");
  command.add_flag("--random-start", options.random_start, "iterate: start from signs at random, not propagated ones")
      ->group(kNormalGroup);
  value("--seed", options.seed, "of the random start")->type_name("N");
}

NormalMethod normal_method_of(const std::string& name, const std::string& option) {
  for (const NormalMethod method : {NormalMethod::automatic, NormalMethod::sensor, NormalMethod::propagate,
                                    NormalMethod::iterate, NormalMethod::repair})
    if (name == name_of(method)) return method;
  throw Error(ErrorCode::usage,
              fmt::format("{}: '{}' is not auto, sensor, propagate, iterate or repair", option, name));
}

NormalOptions normal_options(const NormalArgs& args, const std::string& option) {
  NormalOptions options = args.options;
  options.method = normal_method_of(args.method, option);
  for (const std::string& text : args.sensors) {
    const std::optional<Vec3d> place = parse_vector(text);
    if (!place) throw Error(ErrorCode::usage, fmt::format("--sensor: '{}' is not X,Y,Z", text));
    options.sensors.push_back(*place);
  }
  validate(options);
  return options;
}

Json to_json(const NormalOptions& options) {
  return {{"method", name_of(options.method)},
          {"sensors", options.sensors},
          {"random_start", options.random_start},
          {"seed", options.seed},
          {"max_rounds", options.max_rounds},
          {"time_limit_s", options.time_limit_s},
          {"keep_within_degrees", options.keep_within_degrees}};
}

Json to_json(const NormalReport& report) {
  Json json = {{"method", name_of(report.method)},
               {"assumed", report.assumed},
               {"points", report.points},
               {"given", report.given},
               {"kept", report.kept},
               {"flipped", report.flipped},
               {"replaced", report.replaced},
               {"doubtful", report.doubtful},
               {"patches", report.patches},
               {"components", report.components},
               {"turned", report.turned},
               {"rounds", report.rounds},
               {"settled", report.settled},
               {"enclosing", report.enclosing}};
  json["ms"] = {{"estimate", report.estimate_ms},
                {"propagate", report.propagate_ms},
                {"iterate", report.iterate_ms},
                {"total", report.total_ms}};
  return json;
}

std::string summary(const NormalReport& report) {
  std::string line = fmt::format("normals of {} points by {}", report.points, name_of(report.method));
  if (report.given > 0)
    line += fmt::format(": {} kept, {} flipped ({:.1f} %), {} replaced", report.kept, report.flipped,
                        100 * static_cast<double>(report.flipped) / static_cast<double>(report.given), report.replaced);
  line += fmt::format(
      "; {:.1f} % doubtful; {} trial fields; ms: estimate {:.0f}, propagate {:.0f}, iterate {:.0f}",
      100 * static_cast<double>(report.doubtful) / static_cast<double>(std::max<std::int64_t>(1, report.points)),
      report.rounds, report.estimate_ms, report.propagate_ms, report.iterate_ms);
  return line + "; assumed: " + report.assumed;
}

void warn_about_unsettled(const NormalReport& report) {
  if (!report.settled)
    print_warning("the signs of the normals had not settled when rounds or time ran out; allow more");
}

NormalReport estimate_normals(Cloud& cloud, const NormalOptions& options, const Device& device, bool quiet) {
  ProgressLine line(!quiet && stderr_is_terminal());
  NormalOptions with_progress = options;
  with_progress.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  NormalEstimator estimator(device);
  estimator.orient(cloud, with_progress);
  line.clear();
  const NormalReport& report = estimator.report();
  warn_about_unsettled(report);
  if (const std::optional<Warning> doubts = warning_of_doubts(report)) print_warning(doubts->text);
  if (!quiet) print_note(summary(report));
  return report;
}

}  // namespace pointskin::cli
