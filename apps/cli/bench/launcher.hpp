// Starts programs and measures them from outside.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pointskin::cli {

/// What became of a program.
struct Outcome {
  int start_error = 0;          ///< errno if it could not be started, else 0
  int exit_code = 0;            ///< -1 if a signal ended it
  int signal = 0;               ///< 0 unless a signal ended it
  double seconds = 0;           ///< wall clock, from before its start until its end
  std::int64_t peak_bytes = 0;  ///< largest resident size, of itself or of a program that it waited for

  [[nodiscard]] bool succeeded() const { return start_error == 0 && exit_code == 0 && signal == 0; }
};

/// "exit status 3", "signal 11 (Segmentation fault)", "cannot be started: No such file or directory".
std::string describe(const Outcome& outcome);

/// A small process that starts the programs. Linux counts what the starting process holds into the peak memory of the
/// program started, so whoever starts them must hold little: make this before anything large, and before any thread.
/// The programs, and what they start, end with this object.
class Launcher {
 public:
  /// @throws Error internal if the system refuses
  Launcher();
  ~Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Runs `words` (a program of PATH or with a slash, and its arguments), without stdin, output going to the file
  /// `log`.
  /// @throws Error internal if the launching process is gone, over_limit if the words are too long, interrupted
  Outcome run(const std::vector<std::string>& words, const std::string& log) const;

 private:
  int socket_ = -1;
  pid_t id_ = -1;
};

/// True if `program` could be started: a file with a slash, or one of PATH, that may be executed.
bool is_executable(const std::string& program);

}  // namespace pointskin::cli
