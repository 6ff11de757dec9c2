// What the engine is to do, one after the other. Where a slider or a handle moves, only the newest request counts.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "requests.hpp"

namespace pointskin::studio {

/// Requests of one slot drive out each other: the older one is dropped before it starts, and told to stop where it
/// runs. Those without a slot are done in their order, and make a running one with a slot stop, too. Jobs of the
/// background wait for all others and make way for them: they begin again later.
/// All functions may be called from any thread.
class JobQueue {
 public:
  struct Job {
    Request request;
    std::string slot;  ///< empty: is never dropped
    bool background = false;
  };

  static constexpr std::size_t kMostJobs = 256;

  /// @returns false if too many are waiting; the job is not taken then
  bool push(Job job);

  /// The next job, one of the background if there is no other; nothing if none came within `wait`, or after close().
  std::optional<Job> next(std::chrono::milliseconds wait);

  /// The job that next() gave is done.
  void finished();

  /// Takes a running job of the background back that made way for another; before finished().
  /// @returns false if it is not to be done any more: it was cancelled, or a newer one of its slot waits
  bool put_back(Job job);

  /// Whether the running job should end: it was cancelled, or something newer takes its place.
  [[nodiscard]] bool should_stop() const;
  /// Whether a job waits, not of the background.
  [[nodiscard]] bool waiting() const;
  /// Whether a job of this slot waits: what is worked on for the page is old.
  [[nodiscard]] bool waiting(const std::string& slot) const;

  /// Ends the running job, as soon as it looks.
  void cancel();
  void close();
  [[nodiscard]] bool closed() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::optional<std::string> running_;  ///< its slot
  bool runs_background_ = false;
  bool cancelled_ = false, closed_ = false;
};

}  // namespace pointskin::studio
