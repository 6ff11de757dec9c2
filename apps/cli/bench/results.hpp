// What `pointskin bench` has measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/reconstruct.hpp>

#include "resident_runs.hpp"
#include "statistics.hpp"

namespace pointskin::cli {

struct CloudFacts {
  std::string name;          ///< for people
  std::string path;          ///< empty: generated
  std::string shape;         ///< of a generated cloud
  std::int64_t points = 0;   ///< used
  std::int64_t dropped = 0;  ///< not finite, or without a normal
};

/// Runs on data in memory: points on the device to mesh on the device.
struct MemoryRun {
  std::size_t cloud = 0;  ///< index in Results::clouds
  Device device;
  int depth = 0;
  std::int64_t nodes = 0, vertices = 0, triangles = 0;
  std::int64_t peak_bytes = 0;  ///< largest sum of buffers held at once
  std::vector<ResidentRun> times;
};

/// Runs of a whole program: file to file.
struct FileRun {
  std::size_t cloud = 0;
  int depth = 0;
  std::string program;               ///< "pointskin cpu", "PoissonRecon"
  bool is_peer = false;              ///< false: this program
  std::vector<std::string> command;  ///< of the last run
  std::vector<double> seconds;       ///< of the runs that worked
  std::int64_t peak_bytes = 0;       ///< largest resident size over the runs
  std::string failure;               ///< empty unless a run failed: how; no further ones were made
};

struct Results {
  std::vector<CloudFacts> clouds;
  std::vector<MemoryRun> memory_runs;
  std::vector<FileRun> file_runs;  ///< those of a cloud and depth are neighbours, the peer's last
};

/// Spread of `ms(run)` over the runs, in milliseconds.
template <class Ms>
Spread spread_of(const MemoryRun& run, const Ms& ms) {
  std::vector<double> values;
  for (const ResidentRun& times : run.times) values.push_back(ms(times));
  return spread_of(std::move(values));
}

// Columns of the paper's table, in milliseconds.
inline double octree_ms(const ResidentRun& t) { return t.octree_ms; }
inline double function_ms(const ResidentRun& t) { return t.splat_ms + t.solve_ms; }
inline double surface_ms(const ResidentRun& t) { return t.extract_ms; }
inline double total_ms(const ResidentRun& t) { return t.total_ms; }

/// The peer's run on the same cloud at the same depth, or nothing if it failed or there is none.
const FileRun* peer_of(const Results& results, const FileRun& run);

}  // namespace pointskin::cli
