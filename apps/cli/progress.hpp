// One line of progress on a terminal.
#pragma once

#include <string>

#include <pointskin/reconstruct.hpp>

#include "stopwatch.hpp"

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
  bool shown_;
  bool on_screen_ = false;
  Stopwatch watch_;
  double last_ms_ = 0;
};

/// "solve  42 %, 3 s left". @param elapsed_s  since fraction was zero
std::string progress_text(const Progress& progress, double elapsed_s);

}  // namespace pointskin::cli
