// SIGINT, SIGTERM and SIGPIPE.
#pragma once

#include <string>

namespace pointskin::cli {

/// What the first SIGINT or SIGTERM does. A second one always kills.
enum class OnInterrupt {
  exit_now,  ///< leave at once with 130: nothing is being written, and reading cannot be cancelled otherwise
  remember,  ///< set a flag that interrupted() shows
};

/// Installs the handlers, starting with OnInterrupt::exit_now, and ignores SIGPIPE, so that writing to a closed pipe is
/// an error like any other.
void install_signal_handlers();

void on_interrupt(OnInterrupt what);

/// Counts a frame of a sequence, for interrupted_text().
void frame_was_written() noexcept;

/// What to tell people: that nothing was written, or how many frames of a sequence were.
std::string interrupted_text();

/// True once a signal has been remembered.
bool interrupted() noexcept;

/// @throws Error interrupted if interrupted()
void throw_if_interrupted();

}  // namespace pointskin::cli
