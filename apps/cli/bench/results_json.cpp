#include "bench/results_json.hpp"

#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string system_name() {
  struct utsname name = {};
  return uname(&name) == 0 ? fmt::format("{} {} {}", name.sysname, name.release, name.machine) : "unknown";
}

Json machine_json(const std::vector<Device>& devices) {
  Json gpus = Json::array();
  for (const Device& device : devices) {
    if (device.kind == DeviceKind::cuda) gpus.push_back(device.name());
  }
  const auto bytes = static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  return {{"cpu", cpu_model()},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_bytes", bytes},
          {"gpus", gpus},
          {"system", system_name()}};
}

/// The words that this process was started with.
std::vector<std::string> command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  return words;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  struct tm parts = {};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

Json spread_json(const Spread& spread) { return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}}; }

Json cloud_json(const CloudFacts& cloud) {
  const auto text = [](const std::string& value) { return value.empty() ? Json(nullptr) : Json(value); };
  return {{"name", cloud.name},
          {"path", text(cloud.path)},
          {"shape", text(cloud.shape)},
          {"points", cloud.points},
          {"dropped", cloud.dropped}};
}

Json memory_run_json(const Results& results, const MemoryRun& run) {
  const Spread total = spread_of(run, total_ms);
  Json json = {{"cloud", results.clouds[run.cloud].name},
               {"points", results.clouds[run.cloud].points},
               {"device", short_name(run.device)},
               {"device_name", run.device.name()},
               {"depth", run.depth},
               {"nodes", run.nodes},
               {"vertices", run.vertices},
               {"triangles", run.triangles},
               {"repeat", run.times.size()}};
  json["ms"] = {{"octree", spread_json(spread_of(run, octree_ms))},
                {"splat", spread_json(spread_of(run, [](const ResidentRun& t) { return t.splat_ms; }))},
                {"solve", spread_json(spread_of(run, [](const ResidentRun& t) { return t.solve_ms; }))},
                {"function", spread_json(spread_of(run, function_ms))},
                {"extract", spread_json(spread_of(run, surface_ms))},
                {"total", spread_json(total)}};
  json["frames_per_second"] = 1000 / total.median;
  json["memory_bytes"] = run.peak_bytes;
  return json;
}

Json file_run_json(const Results& results, const FileRun& run) {
  Json json = {{"cloud", results.clouds[run.cloud].name},
               {"points", results.clouds[run.cloud].points},
               {"depth", run.depth},
               {"program", run.program},
               {"peer", run.is_peer},
               {"command", run.command},
               {"repeat", run.seconds.size()}};
  if (!run.failure.empty()) json["failure"] = run.failure;
  if (run.seconds.empty()) return json;
  json["seconds"] = spread_json(spread_of(run.seconds));
  json["peak_bytes"] = run.peak_bytes;
  if (const FileRun* peer = peer_of(results, run); peer != nullptr) {
    json["speed_up"] = spread_of(peer->seconds).median / spread_of(run.seconds).median;
  }
  return json;
}

}  // namespace

Json to_json(const Results& results, const BenchArgs& args, const std::vector<Device>& devices) {
  Json json = {{"version", 1}, {"command", "bench"}};
  json["program"] = {{"version", POINTSKIN_VERSION}, {"commit", POINTSKIN_COMMIT}};
  json["command_line"] = command_line();
  json["time"] = utc_now();
  json["machine"] = machine_json(devices);
  json["options"] = report_of(bench_options, args);
  for (const char* list : {"clouds", "runs", "file_runs"}) json[list] = Json::array();
  for (const CloudFacts& cloud : results.clouds) json["clouds"].push_back(cloud_json(cloud));
  for (const MemoryRun& run : results.memory_runs) json["runs"].push_back(memory_run_json(results, run));
  for (const FileRun& run : results.file_runs) json["file_runs"].push_back(file_run_json(results, run));
  return json;
}

}  // namespace pointskin::cli
