#include "console.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

/// https://no-color.org: any non-empty value turns colour off.
bool use_colour() {
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  if (no_color != nullptr && no_color[0] != '\0') return false;
  return stderr_is_terminal() && term != nullptr && std::string_view(term) != "dumb";
}

/// The program is one run of one command: what it has said is its own.
std::vector<std::string>& warnings() {
  static std::vector<std::string> all;
  return all;
}

}  // namespace

bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }

void print_error(const std::string& story) {
  const std::string name = use_colour() ? "\x1b[1;31mpointskin:\x1b[0m" : "pointskin:";
  print_note(fmt::format("{} {}", name, one_line(story)));
}

void print_warning(const std::string& story) {
  const std::string line = one_line(story);
  warnings().push_back(line);
  print_note("pointskin: warning: " + line);
}

const std::vector<std::string>& printed_warnings() { return warnings(); }

void print_note(const std::string& text) {
  const std::string line = text + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);  // One call: lines of several processes do not mix.
}

void write_stdout(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (std::fflush(stdout) == 0 && written) return;
  throw Error(ErrorCode::output_not_written, fmt::format("cannot write to stdout: {}", std::strerror(errno)));
}

std::string format_bytes(double bytes) {
  constexpr std::array kUnits = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
  return unit == 0 ? fmt::format("{:.0f} bytes", bytes) : fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

}  // namespace pointskin::cli
