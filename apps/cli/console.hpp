// What the program says: errors, warnings and notes on stderr, data on stdout. Of several ranks the first one says it.
#pragma once

#include <string>
#include <vector>

#include "scene/text.hpp"

namespace pointskin::cli {

/// True if people read stderr: it is a terminal.
bool stderr_is_terminal();

/// Prints "pointskin: `story`" as exactly one line on stderr. The name is red on a terminal unless NO_COLOR is set.
void print_error(const std::string& story);

/// The error that is told without taking memory. Nothing is printed on stderr after it.
void print_out_of_memory() noexcept;

/// Prints "pointskin: warning: `story`" as one line on stderr, and remembers it. Threads with a WarningsOf may do so at
/// once, others in turn.
void print_warning(const std::string& story);

/// While it lives, warnings of the thread that made it are about one of several files, and are printed with its name
/// before them. Those about all files, which came before, are among its stories. Not to be nested.
class WarningsOf {
 public:
  explicit WarningsOf(std::string file);
  ~WarningsOf();
  WarningsOf(const WarningsOf&) = delete;
  WarningsOf& operator=(const WarningsOf&) = delete;

 private:
  friend void print_warning(const std::string& story);
  friend const std::vector<std::string>& printed_warnings();
  std::string file_;
  std::vector<std::string> stories_;
};

/// The stories of all warnings printed so far, for reports; those of the file, where this thread has a WarningsOf.
const std::vector<std::string>& printed_warnings();

/// Prints `text` and a line break on stderr, control characters but line breaks and tabs as "?".
void print_note(const std::string& text);

/// Writes `text` to stdout, control characters but line breaks and tabs as "?", and flushes it.
/// @throws Error output_not_written, for example when the reader has closed its end of a pipe
void write_stdout(const std::string& text);

/// "640 bytes", "12.0 KiB", "3.4 GiB": powers of 1024.
std::string format_bytes(double bytes);

using scene::one_line;

}  // namespace pointskin::cli
