// Times of a run's phases.
#pragma once

#include <utility>
#include <vector>

#include "exec/space.hpp"

namespace pointskin::detail {

/// Measures phases on the space's own clock, without waiting at their borders.
template <exec::Space Exec>
class PhaseClock {
 public:
  explicit PhaseClock(Exec& ex) : ex_(ex), start_(ex.mark()) {}

  /// Ends a phase and begins the next; the phase's milliseconds go to `to` when read() is called.
  void lap(double& to) {
    const Mark now = ex_.mark();
    phases_.push_back({std::exchange(start_, now), now, &to});
  }

  /// Waits until all phases are done.
  void read() {
    for (const Phase& phase : phases_) *phase.milliseconds = ex_.milliseconds_between(phase.from, phase.to);
    phases_.clear();
  }

 private:
  using Mark = typename Exec::Mark;
  struct Phase {
    Mark from, to;
    double* milliseconds;
  };
  Exec& ex_;
  Mark start_;
  std::vector<Phase> phases_;
};

}  // namespace pointskin::detail
