#include "normal_args.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "args.hpp"
#include "console.hpp"
#include "progress.hpp"
#include "signals.hpp"

namespace pointskin::cli {

using Json = nlohmann::ordered_json;

Binding method_of(NormalMethod& method) {
  std::vector<std::pair<std::string, NormalMethod>> meanings;
  for (const NormalMethod each : {NormalMethod::automatic, NormalMethod::sensor, NormalMethod::propagate,
                                  NormalMethod::iterate, NormalMethod::repair})
    meanings.emplace_back(name_of(each), each);
  return one_of(method, meanings);
}

OptionGroup normal_options(NormalArgs& args) {
  NormalOptions& o = args.options;
  return {
      kNormalGroup,
      {option("", "", method_of(o.method), {"method", 40}),
       option("--sensor X,Y,Z", "where a scanner stood, world coordinates; may be repeated, the nearest saw a point",
              shown_as(&args.sensors, [&o] { return o.sensors; }), {"sensors", 41}),
       option("--keep-within A", "repair: largest angle of a normal that stays, degrees, 0 to 90",
              &o.keep_within_degrees, {"keep_within_degrees", 46, R"({"minimum": 0, "maximum": 90})"}),
       option("--max-rounds N", "trial reconstructions at most, 1 to 1000", &o.max_rounds,
              {"max_rounds", 44, kFromOne}),
       option("--time-limit S", "begin no further trial after so many seconds, 0: no limit", &o.time_limit_s,
              {"time_limit_s", 45, kFromZero}),
       option("--random-start", "iterate: start from signs at random, not propagated ones", &o.random_start,
              {"random_start", 42}),
       option("--seed N", "of the random start", &o.seed, {"seed", 43, kFromZero})}};
}

NormalOptions library_options(const NormalArgs& args) {
  NormalOptions options = args.options;
  for (const std::string& text : args.sensors) {
    const std::optional<Vec3d> place = parse_vector(text);
    if (!place) throw_usage(fmt::format("--sensor: '{}' is not X,Y,Z", text));
    options.sensors.push_back(*place);
  }
  validate(options);
  return options;
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
