// Runs the program pointskin and looks at what it says.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pointskin::test {

/// How many times longer programs take under the tool that the tests were compiled for.
#ifdef __SANITIZE_THREAD__
inline constexpr int kSlowdown = 4;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr int kSlowdown = 2;
#else
inline constexpr int kSlowdown = 1;
#endif

struct Result {
  int exit_code = -1;      ///< -1 if a signal ended it
  int signal = 0;          ///< 0 unless a signal ended it
  bool timed_out = false;  ///< it was killed because it ran too long
  std::string out, err;    ///< what it wrote
  double seconds = 0;
};

/// How to start the program; what a test does not set is quiet: empty stdin, no terminal.
struct Start {
  std::vector<std::string> args;
  std::string program;                        ///< empty: pointskin
  std::string input;                          ///< bytes on stdin
  bool keep_stdin_open = false;               ///< stdin never ends, as from a person who types nothing
  bool close_stdout = false;                  ///< the reader of stdout is gone
  bool terminal = false;                      ///< stderr is a terminal
  std::vector<std::string> environment;       ///< "NAME=value", added
  std::string folder;                         ///< working folder; empty: the test's own
  int signal = 0;                             ///< signal to send...
  std::chrono::milliseconds signal_after{0};  ///< ...after this time...
  std::string signal_once_written;            ///< ...and not before this file holds something...
  bool signal_once_read = false;              ///< ...and not before the program has read all of `input`
  std::chrono::seconds limit{60 * kSlowdown};
};

Result run_program(const Start& start);

/// Runs `script` in a shell, in `folder`, with pointskin as "$P".
Result run_shell(const std::string& script, const std::string& folder);

/// run_program with arguments alone.
Result pointskin_run(const std::vector<std::string>& args);

/// Expects that a program ended with this code and exactly one line on stderr, which holds `part`.
void expect_error(const Result& result, int code, const std::string& part);

/// True if `text` is exactly one line that starts with "pointskin: ".
bool is_one_error_line(const std::string& text);

/// The bytes in brackets behind `words` in what a dry run prints; 0 if there are none.
std::int64_t bytes_after(const std::string& words, const std::string& text);

}  // namespace pointskin::test
