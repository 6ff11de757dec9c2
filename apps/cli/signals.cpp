#include "signals.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <string>

#include <pointskin/error.hpp>

#include "ranks.hpp"

namespace pointskin::cli {
namespace {

std::atomic<OnInterrupt> what_to_do{OnInterrupt::exit_now};
std::atomic<bool> signal_came{false};
std::atomic<bool> stop_work{false};
std::atomic<bool> never_stop{false};
std::atomic<bool> tells{true};
std::atomic<std::int64_t> written_frames{0}, written_files{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<OnInterrupt>::is_always_lock_free,
              "a signal handler must not take a lock");

void handle(int /*signal*/) {
  const OnInterrupt what = what_to_do.load();
  if (what == OnInterrupt::exit_now) {
    constexpr char kStory[] = "pointskin: interrupted; nothing was written\n";
    const std::size_t bytes = tells.load() ? sizeof kStory - 1 : 0;
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kStory, bytes);
    _exit(static_cast<int>(ErrorCode::interrupted));
  }
  signal_came.store(true);
  if (what != OnInterrupt::remember) return;
  stop_work.store(true);
  alarm(1);
}

/// Ends a call of the system that began to wait after the flag had been asked, and before it was set.
void ring_again(int /*signal*/) { alarm(1); }

/// Without SA_RESTART: who waits for a pipe is to wake up and to look at the flag.
void install(int signal, void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = flags;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void install_signal_handlers() {
  tells.store(tells_for_all());
  install(SIGINT, handle, static_cast<int>(SA_RESETHAND));  // RESETHAND: the second one kills.
  install(SIGTERM, handle, static_cast<int>(SA_RESETHAND));
  install(SIGALRM, ring_again, 0);
  std::signal(SIGPIPE, SIG_IGN);  // failed writes are errors with a reason, not deaths
  std::signal(SIGXFSZ, SIG_IGN);
}

void on_interrupt(OnInterrupt what) noexcept { what_to_do.store(what); }

InterruptScope::InterruptScope() : scope_(stop_work) {}
UndisturbedScope::UndisturbedScope() : scope_(never_stop) {}

bool interrupted() noexcept { return signal_came.load(); }

void throw_if_interrupted() {
  if (interrupted()) throw Error(ErrorCode::interrupted, interrupted_text());
}

void frame_was_written() noexcept { ++written_frames; }
void file_was_written() noexcept { ++written_files; }

void ignore_interrupts() noexcept {
  on_interrupt(OnInterrupt::announce);
  stop_work.store(false);
}

std::string interrupted_text() {
  const std::int64_t frames = written_frames.load();
  const std::int64_t files = written_files.load();
  if (frames == 0 && files == 0) return "interrupted; nothing was written";
  if (frames == 0)
    return "interrupted; " + std::to_string(files) + (files == 1 ? " file was" : " files were") + " written before";
  return "interrupted; " + std::to_string(frames) + (frames == 1 ? " frame was" : " frames were") + " written before";
}

}  // namespace pointskin::cli
