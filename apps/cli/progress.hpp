// One line of progress on a terminal.
#pragma once

#include <chrono>
#include <string>

#include <pointskin/reconstruct.hpp>

namespace pointskin::cli {

/// Shows phase, share and expected rest of a run on one line of stderr, from its second second on, at most ten times a
/// second. Clears the line when it goes away.
class ProgressLine {
 public:
  /// @param shown  false: never prints anything
  explicit ProgressLine(bool shown) : shown_(shown) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void update(const Progress& progress);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool on_screen_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

/// "solve  42 %, 3 s left". @param elapsed_s  since fraction was zero
std::string progress_text(const Progress& progress, double elapsed_s);

}  // namespace pointskin::cli
