// The processes of a run that a launcher of MPI started.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/ranks.hpp>

namespace pointskin::cli {

/// True if a launcher started this process as one of several.
bool is_one_of_ranks() noexcept;

/// The ranks that this process is one of, or null. MPI is started by the first call.
/// @throws Error device_unavailable as ranks_of_launcher()
Ranks* launched_ranks();

/// False in all but one of the processes that a launcher started: what all find alike, one of them tells.
bool tells_for_all() noexcept;

/// Whether this process tells of its error: of errors that all ranks meet, and of what one error leads to in the others, one tells.
/// Where that is not known, the first rank has three seconds for telling and ending all.
bool tells_of(ErrorCode error) noexcept;

/// The end of main(): of ranks all end where one has met an error, which may be before the others know.
/// @returns the exit code
int end_with_ranks(int exit_code);

}  // namespace pointskin::cli
