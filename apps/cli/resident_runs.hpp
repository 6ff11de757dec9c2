// Runs on points that are where the run works, as a program has them that computes there.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/reconstruct.hpp>

namespace pointskin::cli {

/// One of them, in milliseconds.
struct ResidentRun {
  double octree_ms = 0, splat_ms = 0, solve_ms = 0;
  double extract_ms = 0;       ///< and all else
  double total_ms = 0;         ///< points on the device to mesh on the device
  std::int64_t vertices = 0;   ///< of the mesh
  std::int64_t triangles = 0;  ///< of the mesh
};

/// Copies `cloud` to the device and makes a mesh of it there, `times` times.
/// @throws Error as Reconstructor::reconstruct
std::vector<ResidentRun> run_resident(Reconstructor& reconstructor, const Cloud& cloud, const Options& options,
                                      int times);

}  // namespace pointskin::cli
