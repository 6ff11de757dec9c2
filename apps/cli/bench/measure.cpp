#include "bench/measure.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "bench/bench_args.hpp"
#include "bench/words.hpp"

namespace pointskin::cli {
namespace {

namespace fs = std::filesystem;

/// The last line that says something; programs tell there why they stop.
std::string last_line(const std::string& path) {
  std::ifstream in(path);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  return last;
}

FileRun ours(const Race& race, const Device& device) {
  FileRun run;
  run.depth = race.depth;
  run.program = "pointskin " + short_name(device);
  run.command = {"pointskin",
                 "reconstruct",
                 race.input,
                 "-o",
                 race.folder + "/ours.ply",
                 "--depth",
                 std::to_string(race.depth),
                 "--device",
                 short_name(device),
                 "--threads",
                 std::to_string(race.threads),
                 "-q"};
  return run;
}

FileRun theirs(const Race& race) {
  const unsigned all = std::max(1U, std::thread::hardware_concurrency());
  FileRun run;
  run.depth = race.depth;
  run.program = fs::path(race.peer[0]).filename().string();
  run.is_peer = true;
  run.command =
      fill_in(race.peer, {{"in", race.input},
                          {"out", race.folder + "/peer.ply"},
                          {"depth", std::to_string(race.depth)},
                          {"threads", std::to_string(race.threads > 0 ? race.threads : static_cast<int>(all))}});
  return run;
}

/// Runs it once more. Without a mesh in `output` afterwards it has failed, whatever it says.
void run_once(const Launcher& launcher, FileRun& run, const std::string& output, const std::string& log) {
  std::error_code ignored;
  fs::remove(output, ignored);
  std::vector<std::string> words = run.command;
  if (!run.is_peer) words[0] = "/proc/self/exe";
  const Outcome outcome = launcher.run(words, log);
  const bool has_mesh = fs::exists(output, ignored) && fs::file_size(output, ignored) > 0;
  if (outcome.succeeded() && has_mesh) {
    run.seconds.push_back(outcome.seconds);
    run.peak_bytes = std::max(run.peak_bytes, outcome.peak_bytes);
    return;
  }
  run.failure = describe(outcome);
  if (outcome.succeeded()) run.failure += ", but there is no mesh";
  if (const std::string story = last_line(log); !story.empty()) run.failure += ": " + story;
  if (run.is_peer) return;
  const int code = outcome.exit_code > 0 && outcome.exit_code <= 8 ? outcome.exit_code : 1;
  throw Error(static_cast<ErrorCode>(code), fmt::format("{} failed: {}", quoted(run.command), run.failure));
}

}  // namespace

MemoryRun measure_in_memory(Reconstructor& reconstructor, const Cloud& cloud, const MemoryJob& job) {
  Options options;
  options.depth = job.depth;
  options.progress = [&job](const Progress&) { return job.keep_going(); };
  MemoryRun run;
  run.device = reconstructor.device();
  run.depth = job.depth;
  run.vertices = static_cast<std::int64_t>(reconstructor.reconstruct(cloud, options).vertices.size());
  run.nodes = reconstructor.report().nodes;
  run.peak_bytes = reconstructor.report().device_peak_bytes;
  run.times = run_resident(reconstructor, cloud, options, job.repeat);
  run.triangles = run.times.front().triangles;
  return run;
}

std::vector<FileRun> measure_files(const Launcher& launcher, const Race& race) {
  std::vector<FileRun> runs;
  for (const Device& device : race.devices) runs.push_back(ours(race, device));
  runs.push_back(theirs(race));
  for (int i = 0; i < race.repeat; ++i) {
    for (FileRun& run : runs) {
      if (!run.failure.empty()) continue;
      run_once(launcher, run, race.folder + (run.is_peer ? "/peer.ply" : "/ours.ply"), race.folder + "/log");
    }
  }
  return runs;
}

}  // namespace pointskin::cli
