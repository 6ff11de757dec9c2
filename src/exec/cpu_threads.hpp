// How many threads the system lets this process have.
#pragma once

namespace pointskin::exec {

/// As many of `wanted` threads, the calling one among them, as can be made: limits on address space or processes may
/// forbid some. Never more than 256 unless the machine has more cores. Tried out once for the largest number, in some
/// 20 us a thread. What is left of a limit that was met is not all taken.
/// @param wanted     > 0
/// @param available  what the machine has
int threads_that_can_be_made(int wanted, int available);

/// True where a limit of the process may forbid later what is allowed now: threads are then made at once.
bool threads_are_limited();

}  // namespace pointskin::exec
