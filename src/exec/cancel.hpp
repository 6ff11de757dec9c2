// The flag of CancelScope, as work asks for it.
#pragma once

#include <atomic>

namespace pointskin::exec {

/// The calling thread's flag; null if it has none. Work that it shares out to other threads takes it along.
const std::atomic<bool>* cancel_flag() noexcept;

/// @throws Error interrupted
[[noreturn]] void throw_cancelled();

/// @throws Error interrupted if the flag is there and set
inline void throw_if_cancelled(const std::atomic<bool>* flag) {
  if (flag != nullptr && flag->load(std::memory_order_relaxed)) throw_cancelled();
}

/// Asks the calling thread's own flag: for long loops on one thread, every thousand steps or so.
inline void throw_if_cancelled() { throw_if_cancelled(cancel_flag()); }

}  // namespace pointskin::exec
