// How long the host takes.
#pragma once

#include <chrono>
#include <utility>

namespace pointskin {

/// Starts when it is made. On the host's clock: who measures what a device does waits for it first.
class Stopwatch {
 public:
  /// Milliseconds since the start, or the last lap.
  [[nodiscard]] double milliseconds() const { return since(start_, Clock::now()); }

  /// The same, and the next lap begins.
  double lap() {
    const Clock::time_point now = Clock::now();
    return since(std::exchange(start_, now), now);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
  }
  Clock::time_point start_ = Clock::now();
};

}  // namespace pointskin
