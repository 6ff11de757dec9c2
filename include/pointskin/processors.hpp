// How many processors there are for this process.
#pragma once

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Processors that the calling thread may run on, as taskset, batch systems and launchers of MPI limit them; at least 1. That many
/// threads work where an option or a Device has 0 of them. std::thread::hardware_concurrency() counts all that are online.
int usable_processors() noexcept;

}  // namespace pointskin PSK_EXPORT
