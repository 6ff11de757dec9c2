// Whether memory has ever run out, also where whoever asked for it went on without.
#pragma once

namespace pointskin::cli {

/// From now on operator new remembers that it found no memory.
void watch_memory() noexcept;

[[nodiscard]] bool memory_ran_out() noexcept;

}  // namespace pointskin::cli
