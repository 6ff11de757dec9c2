// What a process does that ends without unwinding.
#pragma once

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Removes the temporary files of all writes under way, in whatever thread, up to 256: for a process that is about to
/// end and cannot unwind, as where no memory is left. Those writes fail if they go on, and so do all later ones. Takes no
/// memory and no lock, waits 0.1 s at most, and may be called by a signal handler.
void remove_unfinished_files() noexcept;

}  // namespace pointskin
