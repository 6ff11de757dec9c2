#include "signals.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <string>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

std::atomic<bool> remember_only{false};
std::atomic<bool> signal_came{false};
std::atomic<std::int64_t> written_frames{0};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not take a lock");

void handle(int /*signal*/) {
  if (!remember_only.load()) {
    constexpr char kStory[] = "pointskin: interrupted; nothing was written\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kStory, sizeof kStory - 1);
    _exit(static_cast<int>(ErrorCode::interrupted));
  }
  signal_came.store(true);
}

void install(int signal) {
  struct sigaction action = {};
  action.sa_handler = handle;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);  // RESETHAND: the second one kills.
  sigaction(signal, &action, nullptr);
}

}  // namespace

void install_signal_handlers() {
  install(SIGINT);
  install(SIGTERM);
  std::signal(SIGPIPE, SIG_IGN);  // failed writes are errors with a reason, not deaths
  std::signal(SIGXFSZ, SIG_IGN);
}

void on_interrupt(OnInterrupt what) { remember_only.store(what == OnInterrupt::remember); }

bool interrupted() noexcept { return signal_came.load(); }

void throw_if_interrupted() {
  if (interrupted()) throw Error(ErrorCode::interrupted, interrupted_text());
}

void frame_was_written() noexcept { ++written_frames; }

std::string interrupted_text() {
  const std::int64_t frames = written_frames.load();
  if (frames == 0) return "interrupted; nothing was written";
  return "interrupted; " + std::to_string(frames) + (frames == 1 ? " frame was" : " frames were") + " written before";
}

}  // namespace pointskin::cli
