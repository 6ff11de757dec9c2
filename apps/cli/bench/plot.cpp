#include "bench/plot.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/bench_args.hpp"
#include "bench/chart.hpp"

namespace pointskin::cli {
namespace {

/// A median, wherever it comes from.
struct Measured {
  std::string who;
  bool whole_program = false;
  std::string cloud;
  std::int64_t points = 0;
  int depth = 0;
  double ms = 0;
};

std::vector<Measured> medians(const Results& results) {
  std::vector<Measured> found;
  for (const MemoryRun& run : results.memory_runs) {
    const CloudFacts& cloud = results.clouds[run.cloud];
    found.push_back({short_name(run.device) + " in memory", false, cloud.name, cloud.points, run.depth,
                     spread_of(run, total_ms).median});
  }
  for (const FileRun& run : results.file_runs) {
    if (run.seconds.empty()) continue;
    const CloudFacts& cloud = results.clouds[run.cloud];
    found.push_back({run.program + " file to file", true, cloud.name, cloud.points, run.depth,
                     1000 * spread_of(run.seconds).median});
  }
  return found;
}

std::string time_text(double ms) { return ms < 1000 ? fmt::format("{:g} ms", ms) : fmt::format("{:g} s", ms / 1000); }

std::string count_text(double count) {
  if (count < 1000) return fmt::format("{:g}", count);
  return count < 1e6 ? fmt::format("{:g} k", count / 1e3) : fmt::format("{:g} M", count / 1e6);
}

/// Ticks with a little room at both ends.
template <class Text>
std::vector<Tick> ticks(double least, double most, const Text& text) {
  constexpr double kRoom = 1.05;
  std::vector<Tick> ticks;
  for (const double value : log_ticks(least / kRoom, most * kRoom)) ticks.push_back({value, text(value)});
  return ticks;
}

/// The axis of depths is that of 2^depth, the cells along a side of the cube.
std::vector<Tick> depth_ticks(int least, int most) {
  if (least == most) --least, ++most;
  std::vector<Tick> ticks;
  for (int depth = least; depth <= most; ++depth) ticks.push_back({std::ldexp(1, depth), std::to_string(depth)});
  return ticks;
}

void add(Chart& chart, const std::string& name, bool dashed, const ChartPoint& point) {
  const auto has_name = [&](const Series& series) { return series.name == name; };
  auto found = std::find_if(chart.series.begin(), chart.series.end(), has_name);
  if (found == chart.series.end()) found = chart.series.insert(found, {name, dashed, {}});
  found->points.push_back(point);
}

void sort_points(Chart& chart) {
  for (Series& series : chart.series) {
    std::stable_sort(series.points.begin(), series.points.end(),
                     [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
  }
}

}  // namespace

std::string plot(const Results& results) {
  const std::vector<Measured> all = medians(results);
  if (all.empty()) return to_svg({});
  const auto range = [&](auto member) {
    return std::minmax_element(all.begin(), all.end(),
                               [=](const Measured& a, const Measured& b) { return a.*member < b.*member; });
  };
  const auto [fewest, most] = range(&Measured::points);
  const auto [flattest, deepest] = range(&Measured::depth);
  const auto [fastest, slowest] = range(&Measured::ms);
  const std::vector<Tick> times = ticks(std::max(fastest->ms, 1e-3), std::max(slowest->ms, 1e-3), time_text);
  Chart points = {"Time against points", "points", {}, times, {}};
  points.x_ticks = ticks(static_cast<double>(fewest->points), static_cast<double>(most->points), count_text);
  Chart depths = {"Time against depth", "octree depth", depth_ticks(flattest->depth, deepest->depth), times, {}};
  for (const Measured& m : all) {
    add(points, fmt::format("{}, depth {}", m.who, m.depth), m.whole_program, {static_cast<double>(m.points), m.ms});
    add(depths, fmt::format("{}, {}", m.who, m.cloud), m.whole_program, {std::ldexp(1, m.depth), m.ms});
  }
  sort_points(points);
  sort_points(depths);
  return to_svg({points, depths});
}

}  // namespace pointskin::cli
