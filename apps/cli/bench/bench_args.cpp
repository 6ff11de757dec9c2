#include "bench/bench_args.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "bench/launcher.hpp"
#include "bench/words.hpp"
#include "fit_args.hpp"

namespace pointskin::cli {
namespace {

/// The parts of "a,b,c".
std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text + ",");
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  return parts;
}

/// The same for devices: a number alone is one more GPU of the device before, as in "cuda:0,2".
std::vector<std::string> device_names(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string& part : parts(text)) {
    const bool is_number = !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && !names.empty() && names.back().starts_with("cuda:"))
      names.back() += "," + part;
    else
      names.push_back(part);
  }
  return names;
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
    devices.push_back(parse_device(name, threads, "--devices", "all, cpu, cuda, cuda:N, cuda:N,M or cuda:all"));
  }
}

/// A check for whole numbers.
std::function<std::string(const std::string&)> in_range(int least, int most) {
  return [least, most](const std::string& text) {
    const double value = parse_number(text).value_or(least - 1);
    const bool good = value >= least && value <= most && value == static_cast<int>(value);
    return good ? "" : fmt::format("Value {} not in range {} to {}", text, least, most);
  };
}

}  // namespace

OptionTable bench_options(BenchArgs& args) {
  const OptionRules text = {.check = needs_a_value};
  return {
      {"Work",
       {option("IN", "oriented clouds, measured one by one [default the paper's six, generated]", &args.inputs),
        option("--generate SHAPE:N", "a cloud of a known shape, e.g. knot:1000000; may be repeated", &args.generate),
        option("--depths D,D,...", "octree depths, 1 to 20 [default 8,9,10; those of the paper for its clouds]",
               &args.depths, {}, text),
        option("--repeat N", "runs on data in memory, 1 to 100000", &args.repeat, {"repeat", 1, kFromOne},
               {.check = in_range(1, 100000)})}},
      {kDeviceGroup,
       {option("--devices DEV,...",
               "cpu, cuda (every GPU), cuda:N, cuda:N,M or cuda:all (as one), separated by commas, or all",
               &args.devices, {}, text),
        threads_row(args.threads)}},
      {"Another program",
       {option("--peer CMD", "its command, with {in}, {out}, {depth}; run in turn with ours, file to file", &args.peer,
               {}, text),
        option("--peer-repeat N", "runs of each, 1 to 1000", &args.peer_repeat, {"peer_repeat", 40, kFromOne},
               {.check = in_range(1, 1000)})}},
      {"Output",
       {option("--report FILE", "write what was measured, and where, as JSON", &args.report, {}, text),
        option("--plot FILE.svg", "draw time against points and depth", &args.plot, {}, text),
        option("-q,--quiet", "no progress on stderr", &args.quiet)}}};
}

std::vector<int> parse_depths(const std::string& text) {
  std::vector<int> depths;
  for (const std::string& part : parts(text)) {
    const double depth = parse_number(part).value_or(0);
    if (!(depth >= 1 && depth <= 20) || depth != static_cast<int>(depth)) {
      throw_usage(fmt::format("--depths: '{}' is no depth; whole numbers in [1, 20], such as 8,9,10", part));
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
  for (const std::string& name : device_names(text)) append_devices(found, name, threads);
  std::vector<Device> devices;
  for (const Device& device : found) {
    const auto same = [&](const Device& other) { return short_name(other) == short_name(device); };
    if (std::none_of(devices.begin(), devices.end(), same)) devices.push_back(device);
  }
  return devices;
}

std::string short_name(const Device& device) { return device.text(); }

std::vector<std::string> parse_peer(const std::string& command) {
  std::vector<std::string> words = split_words(command);
  fill_in(words, {{"in", ""}, {"out", ""}, {"depth", ""}, {"threads", ""}});
  const auto names = [&](const char* name) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return word.find(name) != std::string::npos; });
  };
  if (!names("{in}") || !names("{out}")) {
    throw_usage("--peer: the command must say where {in} and {out} go");
  }
  if (!is_executable(words[0])) {
    throw_usage(fmt::format("--peer: there is no program {} to run", words[0]));
  }
  return words;
}

}  // namespace pointskin::cli
