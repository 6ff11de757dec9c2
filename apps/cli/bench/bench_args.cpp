#include "bench/bench_args.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "bench/launcher.hpp"
#include "bench/words.hpp"
#include "commands.hpp"

namespace pointskin::cli {
namespace {

/// The parts of "a,b,c".
std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text + ",");
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  return parts;
}

void append_gpus(std::vector<Device>& devices) {
  try {
    for (int i = 0;; ++i) devices.push_back(Device::cuda(i));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::device_unavailable) throw;
  }
}

void append_devices(std::vector<Device>& devices, const std::string& name, int threads) {
  if (name == "all") {
    devices.push_back(Device::cpu(threads));
    append_gpus(devices);
  } else if (name == "cuda") {
    devices.push_back(Device::cuda(0));  // tells why there is none
    append_gpus(devices);
  } else {
    devices.push_back(parse_device(name, threads, "--devices", "all, cpu, cuda or cuda:N"));
  }
}

CLI::Option* add_text(CLI::App& command, const std::string& name, std::string& value, const std::string& description) {
  return command.add_option(name, value, description)->check([](const std::string& text) {
    return std::string(text.empty() ? "needs a value" : "");
  });
}

void define_peer(CLI::App& command, BenchArgs& args) {
  const std::string group = "Another program";
  add_text(command, "--peer", args.peer, "its command, with {in}, {out}, {depth}; run in turn with ours, file to file")
      ->type_name("CMD")
      ->group(group);
  command.add_option("--peer-repeat", args.peer_repeat, "runs of each, 1 to 1000")
      ->type_name("N")
      ->group(group)
      ->check(CLI::Range(1, 1000).description(""))
      ->capture_default_str();
}

}  // namespace

void define_bench_options(CLI::App& command, BenchArgs& args) {
  command.add_option("IN", args.inputs, "oriented clouds, measured one by one [default the paper's six, generated]");
  command.add_option("--generate", args.generate, "a cloud of a known shape, e.g. knot:1000000; may be repeated")
      ->type_name("SHAPE:N")
      ->group("Work")
      ->allow_extra_args(false);
  add_text(command, "--depths", args.depths,
           "octree depths, 1 to 20 [default 8,9,10; those of the paper for its clouds]")
      ->type_name("D,D,...")
      ->group("Work");
  command.add_option("--repeat", args.repeat, "runs on data in memory, 1 to 100000")
      ->type_name("N")
      ->group("Work")
      ->check(CLI::Range(1, 100000).description(""))
      ->capture_default_str();
  add_text(command, "--devices", args.devices, "cpu, cuda (every GPU), cuda:N, separated by commas, or all")
      ->type_name("DEV,...")
      ->group("Device and limits")
      ->capture_default_str();
  add_threads_option(command, args.threads, "Device and limits");
  define_peer(command, args);
  add_text(command, "--report", args.report, "write what was measured, and where, as JSON")
      ->type_name("FILE")
      ->group("Output");
  add_text(command, "--plot", args.plot, "draw time against points and depth")->type_name("FILE.svg")->group("Output");
  command.add_flag("-q,--quiet", args.quiet, "no progress on stderr")->group("Output");
}

std::vector<int> parse_depths(const std::string& text) {
  std::vector<int> depths;
  for (const std::string& part : parts(text)) {
    const double depth = parse_number(part).value_or(0);
    if (!(depth >= 1 && depth <= 20) || depth != static_cast<int>(depth)) {
      throw Error(ErrorCode::usage,
                  fmt::format("--depths: '{}' is no depth; whole numbers in [1, 20], such as 8,9,10", part));
    }
    if (std::find(depths.begin(), depths.end(), static_cast<int>(depth)) == depths.end()) {
      depths.push_back(static_cast<int>(depth));
    }
  }
  return depths;
}

std::vector<Device> parse_devices(const std::string& text, int threads) {
  check_threads(threads);
  std::vector<Device> found;
  for (const std::string& name : parts(text)) append_devices(found, name, threads);
  std::vector<Device> devices;
  for (const Device& device : found) {
    const auto same = [&](const Device& other) { return short_name(other) == short_name(device); };
    if (std::none_of(devices.begin(), devices.end(), same)) devices.push_back(device);
  }
  return devices;
}

std::string short_name(const Device& device) {
  return device.kind == DeviceKind::cpu ? "cpu" : fmt::format("cuda:{}", device.index);
}

std::vector<std::string> parse_peer(const std::string& command) {
  std::vector<std::string> words = split_words(command);
  fill_in(words, {{"in", ""}, {"out", ""}, {"depth", ""}, {"threads", ""}});
  const auto names = [&](const char* name) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return word.find(name) != std::string::npos; });
  };
  if (!names("{in}") || !names("{out}")) {
    throw Error(ErrorCode::usage, "--peer: the command must say where {in} and {out} go");
  }
  if (!is_executable(words[0])) {
    throw Error(ErrorCode::usage, fmt::format("--peer: there is no program {} to run", words[0]));
  }
  return words;
}

}  // namespace pointskin::cli
