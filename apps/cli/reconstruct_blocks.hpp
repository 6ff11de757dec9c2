// pointskin reconstruct --max-memory, where the whole does not fit: block after block.
#pragma once

#include "reconstruct_args.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {

/// True if a run whose memory is limited may go on in blocks: on the CPU, from one file that can be read in parts to binary PLY.
bool may_work_in_blocks(const ReconstructArgs& args, const Device& device);

/// True if reading the points as a whole would take more than the limit, so that nothing else needs to be tried.
bool must_work_in_blocks(const ReconstructArgs& args);

/// Reconstructs in blocks, and writes the mesh and the report.
/// @param record  of what was tried as a whole, with the number of points if they were read: then it was said which are left out
/// @throws Error usage if the options ask for what blocks do not do yet; as reconstruct_files()
void reconstruct_in_blocks(const ReconstructArgs& args, const Stopwatch& watch, Record& record);

}  // namespace pointskin::cli
