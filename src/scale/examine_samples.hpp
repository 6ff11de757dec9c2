// The look along the order of keys that settles what samples stand for: which are lonely, and what noise makes of their depths.
#pragma once

#include <cstdint>

#include "exec/cpu.hpp"
#include "scale/block_run.hpp"
#include "scale/sample_values.hpp"
#include "scale/sorted_cloud.hpp"

namespace pointskin::scale {

struct ExaminedSamples {
  double mean_length = 0;    ///< of normals as they were given, with BlockOptions::confidence
  std::uint64_t lonely = 0;  ///< samples that are far from all others
  BoxOfPoints inliers;       ///< in the unit cube: of the samples that are none of them
};

/// What poisson::examine_samples() does for a cloud in memory: areas, depths and trust of all samples, from what weighing has found of them.
/// @param values  areas, depths, bends (as trust) and own sides; areas, examined depths and trust afterwards
/// @throws Error as SortedCloud::read, Spool
/// O(n): two passes over the samples, three with confidence, BlockOptions::part_samples at once. Each rank examines some parts; all find
/// the same. Collective.
ExaminedSamples examine_samples(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                                SampleValues& values);

}  // namespace pointskin::scale
