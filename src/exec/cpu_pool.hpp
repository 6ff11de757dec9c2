// The memory of the CPU space.
#pragma once

#include <memory>

#include "exec/memory.hpp"

namespace pointskin::exec {

/// A pool of the process's own memory. Small blocks are kept in lists by size. Large ones are cut from ranges of pages,
/// and what is freed merges with its neighbours. Before new memory would bring the sum of used and cached memory above
/// 65/64 of the most that was ever in use, or above the limit, cached ranges go back to the system: the process holds
/// little more than the work needs at its peak.
std::shared_ptr<MemoryPool> make_cpu_pool();

}  // namespace pointskin::exec
