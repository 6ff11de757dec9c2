// The measuring itself.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include "bench/launcher.hpp"
#include "bench/results.hpp"

namespace pointskin::cli {

struct MemoryJob {
  int depth = 8;
  int repeat = 10;
  std::function<bool()> keep_going;  ///< called a few times a run; false stops
};

/// One run to warm up, which also tells memory and nodes, then `repeat` runs on data in memory. Leaves `cloud` of the
/// result at 0.
/// @throws Error as Reconstructor::reconstruct
MemoryRun measure_in_memory(Reconstructor& reconstructor, const Cloud& cloud, const MemoryJob& job);

/// What two programs do in turn.
struct Race {
  std::string input;   ///< file
  std::string folder;  ///< for outputs
  int depth = 8;
  int threads = 0;
  int repeat = 3;
  std::vector<Device> devices;    ///< ours runs once a round on each
  std::vector<std::string> peer;  ///< words, with {in}, {out}, {depth}, {threads}
};

/// Runs every one `repeat` times, in turn, so that a machine that slows down slows down all of them.
/// @returns ours by device, then the peer; `cloud` of the results stays 0
/// @throws Error if ours fails, with its exit code
std::vector<FileRun> measure_files(const Launcher& launcher, const Race& race);

}  // namespace pointskin::cli
