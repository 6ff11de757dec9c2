// How long a run from file to file takes, on the CPU and on a GPU: a model, to choose between them.
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include "exec/cpu.hpp"

namespace pointskin::detail {

/// What the time depends on.
struct RunWork {
  double points = 0;
  double nodes = 0;  ///< of the octree, on all levels
};

/// Guesses at the nodes from a sample of the points: the cells of a level that the sample fills well tell the area of
/// the surface, and that how many nodes a finer level has, fewer where points lie farther apart than its cells.
/// Within a third of RunReport::nodes for surfaces whose points are about equally dense.
/// @throws Error as octree::frame_around; empty_result if no point of the sample is finite
/// O(sample), at most 2^18 points.
RunWork guess_work(exec::Cpu& ex, const Cloud& cloud, const Options& options);

/// Wall clock of the program, begin to end, files in the page cache.
double seconds_on_cpu(const RunWork& work, int threads);
/// The same, with the start of the driver.
double seconds_on_gpu(const RunWork& work);

}  // namespace pointskin::detail
