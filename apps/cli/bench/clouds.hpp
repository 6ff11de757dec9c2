// The clouds that `pointskin bench` measures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "bench/bench_args.hpp"

namespace pointskin::cli {

/// A cloud to come, and the depths to measure it at.
struct CloudSource {
  std::string name;               ///< for people
  std::string path;               ///< file; empty: generated
  std::string shape;              ///< of a generated cloud, as make_shape() of bench/shapes knows it
  std::int64_t shape_points = 0;  ///< of a generated cloud
  std::vector<int> depths;
};

/// What the command line asks for: files, generated clouds, or the paper's table, whose scans are not public as they
/// were: generated surfaces with as many points, at the same depths, that come to 0.8 to 1.6 times as many triangles.
/// @throws Error usage
std::vector<CloudSource> cloud_sources(const BenchArgs& args);

/// Reads or generates the cloud; points without a normal are dropped. Generated clouds do not depend on `threads`.
/// @throws Error as read_clouds
Cloud load(const CloudSource& source, int threads);

}  // namespace pointskin::cli
