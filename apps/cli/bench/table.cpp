#include "bench/table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "bench/bench_args.hpp"
#include "console.hpp"

namespace pointskin::cli {
namespace {

std::string file_row(const Results& results, const FileRun& run, std::size_t name_width, std::size_t program_width) {
  std::string row = fmt::format("{:<{}}  {:>5}  {:<{}}", results.clouds[run.cloud].name, name_width, run.depth,
                                run.program, program_width);
  if (run.seconds.empty()) return fmt::format("{}  failed: {}\n", row, one_line(run.failure));
  const Spread seconds = spread_of(run.seconds);
  row += fmt::format("{:>10.3f}{:>10.3f}{:>10.3f}{:>12}", seconds.median, seconds.min, seconds.max,
                     format_bytes(static_cast<double>(run.peak_bytes)));
  const FileRun* peer = peer_of(results, run);
  if (peer != nullptr) row += fmt::format("{:>9.2f}", spread_of(peer->seconds).median / seconds.median);
  return row + (run.failure.empty() ? "\n" : fmt::format("  then failed: {}\n", one_line(run.failure)));
}

}  // namespace

const FileRun* peer_of(const Results& results, const FileRun& run) {
  const auto found = std::find_if(results.file_runs.begin(), results.file_runs.end(), [&](const FileRun& other) {
    return other.is_peer && other.cloud == run.cloud && other.depth == run.depth && !other.seconds.empty();
  });
  return found == results.file_runs.end() ? nullptr : &*found;
}

std::string memory_header(std::size_t name_width) {
  return fmt::format("{:<{}}  {:<7}{:>10}{:>6}{:>11}{:>10}{:>10}{:>10}{:>10}{:>12}{:>9}\n", "cloud", name_width,
                     "device", "points", "depth", "triangles", "octree", "function", "surface", "total ms", "memory",
                     "frames/s");
}

std::string memory_row(const Results& results, const MemoryRun& run, std::size_t name_width) {
  const double total = spread_of(run, total_ms).median;
  return fmt::format("{:<{}}  {:<7}{:>10}{:>6}{:>11}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>12}{:>9.2f}\n",
                     results.clouds[run.cloud].name, name_width, short_name(run.device),
                     results.clouds[run.cloud].points, run.depth, run.triangles, spread_of(run, octree_ms).median,
                     spread_of(run, function_ms).median, spread_of(run, surface_ms).median, total,
                     format_bytes(static_cast<double>(run.peak_bytes)), 1000 / total);
}

std::string file_table(const Results& results, std::size_t name_width) {
  std::size_t program_width = 7;
  for (const FileRun& run : results.file_runs) program_width = std::max(program_width, run.program.size());
  std::string table = "\nFile to file, in turn:\n";
  table += fmt::format("{:<{}}  {:>5}  {:<{}}{:>10}{:>10}{:>10}{:>12}{:>9}\n", "cloud", name_width, "depth", "program",
                       program_width, "median s", "min s", "max s", "memory", "speed-up");
  for (const FileRun& run : results.file_runs) table += file_row(results, run, name_width, program_width);
  return table;
}

}  // namespace pointskin::cli
