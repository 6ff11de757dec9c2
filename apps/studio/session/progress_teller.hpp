// How far a job is, for pages: its phase, its share and when it will be done.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <pointskin/progress.hpp>

#include "services.hpp"

namespace pointskin::studio {

/// Lives as long as a job that may take long. Nothing is told of the first 150 ms, then every 50 ms at most.
class ProgressTeller {
 public:
  ProgressTeller(Services& services, std::string job);
  /// Tells that the job is over, if it told anything.
  ~ProgressTeller();
  ProgressTeller(const ProgressTeller&) = delete;
  ProgressTeller& operator=(const ProgressTeller&) = delete;

  /// For RunOptions::progress and its like. @returns false if the job should end
  bool operator()(const Progress& progress);

  /// Milliseconds of each phase that was entered so far, by its name; the last one lasts until now.
  [[nodiscard]] Json phase_ms() const;

 private:
  using Clock = std::chrono::steady_clock;

  Services& services_;
  std::string job_;
  Clock::time_point start_ = Clock::now(), told_{};
  bool has_told_ = false;
  std::vector<std::pair<std::string, Clock::time_point>> phases_;  ///< and when each began
};

}  // namespace pointskin::studio
