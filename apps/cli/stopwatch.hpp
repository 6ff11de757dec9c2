#pragma once

#include <chrono>

namespace pointskin::cli {

class Stopwatch {
 public:
  /// Milliseconds since construction.
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace pointskin::cli
