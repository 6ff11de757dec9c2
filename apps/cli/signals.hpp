// SIGINT, SIGTERM and SIGPIPE.
#pragma once

#include <string>

#include <pointskin/cancel.hpp>

namespace pointskin::cli {

/// What the first SIGINT or SIGTERM does. A second one always kills.
enum class OnInterrupt {
  exit_now,  ///< leave at once with 130: nothing is being written, and reading cannot be cancelled otherwise
  remember,  ///< set a flag that interrupted() shows, and that ends whatever the library does in an InterruptScope
  announce,  ///< set the flag that interrupted() shows, and nothing else: the command ends by itself
};

/// Installs the handlers, starting with OnInterrupt::exit_now, and ignores SIGPIPE, so that writing to a closed pipe is
/// an error like any other.
void install_signal_handlers();

void on_interrupt(OnInterrupt what) noexcept;

/// Counts a frame of a sequence, for interrupted_text().
void frame_was_written() noexcept;

/// Counts a file that is written before others of the same run, for interrupted_text().
void file_was_written() noexcept;

/// All that was to be written is: from here on the first signal changes nothing, nor does one that has just come.
void ignore_interrupts() noexcept;

/// What to tell people: that nothing was written, or how many frames of a sequence or files were.
std::string interrupted_text();

/// While it lives, the first signal that is remembered ends what its thread asks of the library.
class InterruptScope {
 public:
  InterruptScope();

 private:
  CancelScope scope_;
};

/// While it lives, its thread ends what it has begun: the second file of a frame.
class UndisturbedScope {
 public:
  UndisturbedScope();

 private:
  CancelScope scope_;
};

/// True once a signal has been remembered.
bool interrupted() noexcept;

/// @throws Error interrupted if interrupted()
void throw_if_interrupted();

}  // namespace pointskin::cli
