// pointskin reconstruct --max-memory, where the whole does not fit: block after block.
#pragma once

#include "reconstruct_args.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {

/// True if there is one input, which is a pipe: for blocks it must be spooled first.
bool comes_through_pipe(const ReconstructArgs& args);

/// True if a run whose memory is limited may go on in blocks: from files that can be read in parts, or one pipe, to binary PLY.
bool may_work_in_blocks(const ReconstructArgs& args);

/// @throws Error usage for what several ranks do not do, which work in blocks
void check_ranks(const ReconstructArgs& args);

/// The device of one of several ranks: of the GPUs that --device names those of a host are dealt to its ranks in turn.
Device device_of_rank(const ReconstructArgs& args);

/// True if reading the points as a whole might take more than the limit, so that the whole is not to be tried; false where blocks do
/// not do what the options ask for.
bool must_work_in_blocks(const ReconstructArgs& args, const Options& options, const Device& device);

/// Prints what that would take: blocks, memory and temporary data.
/// @throws Error as reconstruct_in_blocks()
void print_plan(const ReconstructArgs& args, const Record& record);

/// Reconstructs in blocks and writes the mesh; measures it where a report is asked for.
/// @param record  of what was tried as a whole, with the number of points if they were read: then it was said which are left out
/// @throws Error usage if the options ask for what blocks do not do yet; as reconstruct_files()
void reconstruct_in_blocks(const ReconstructArgs& args, const Stopwatch& watch, Record& record);

}  // namespace pointskin::cli
