// The command line of `pointskin bench`.
#pragma once

#include <string>
#include <vector>

#include <pointskin/device.hpp>

#include "given_options.hpp"
#include "option_table.hpp"

namespace pointskin::cli {

struct BenchArgs {
  std::vector<std::string> inputs;    ///< files, a cloud each
  std::vector<std::string> generate;  ///< "SHAPE:POINTS"; without these and inputs, the clouds of the paper's table
  std::string depths;                 ///< empty: 8,9,10, or those of the paper's table
  std::string devices = "all";
  std::string peer;    ///< command of another program, empty: none
  std::string report;  ///< empty: none
  std::string plot;    ///< empty: none
  int threads = 0;
  int repeat = 10;
  int peer_repeat = 3;
  bool quiet = false;
  GivenOptions given;
};

OptionTable bench_options(BenchArgs& args);

/// "8,9,10": the depths in this order, without repetitions.
/// @throws Error usage for anything else, and for depths outside of [1, 20]
std::vector<int> parse_depths(const std::string& text);

/// "cpu,cuda": the CPU and every GPU; "all": every device present; "cuda:1"; "cuda:0,2" and "cuda:all": several GPUs as
/// one. Without repetitions.
/// @throws Error usage, device_unavailable
std::vector<Device> parse_devices(const std::string& text, int threads);

/// "cpu", "cuda:0", "cuda:0,2": what --device of reconstruct takes.
std::string short_name(const Device& device);

/// The words of --peer.
/// @throws Error usage if it does not name {in} and {out}, names anything unknown, or cannot be executed
std::vector<std::string> parse_peer(const std::string& command);

}  // namespace pointskin::cli
