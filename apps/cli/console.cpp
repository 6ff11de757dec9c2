#include "console.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "ranks.hpp"

namespace pointskin::cli {
namespace {

/// https://no-color.org: any non-empty value turns colour off.
bool use_colour() {
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  if (no_color != nullptr && no_color[0] != '\0') return false;
  return stderr_is_terminal() && term != nullptr && std::string_view(term) != "dumb";
}

thread_local WarningsOf* about = nullptr;

/// The program is one run of one command: what it has said is its own. A thread without a WarningsOf that prints while
/// others do sees to it that they take turns.
std::vector<std::string>& warnings() {
  static std::vector<std::string> all;
  return all;
}

/// Names in files are data of others: they must not steer the terminal.
std::string without_controls(std::string text) {
  for (char& c : text) {
    const auto code = static_cast<unsigned char>(c);
    if ((code < 0x20 && c != '\n' && c != '\t') || code == 0x7f) c = '?';
  }
  return text;
}

/// Nothing follows the last line, also not from threads that do not know yet that the process ends.
std::atomic<bool> last_line_written{false};

void write_line(const std::string& text) {
  if (last_line_written) return;
  const std::string line = text + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);  // One call: lines of several processes do not mix.
}

}  // namespace

bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }

void print_error(const std::string& story) {
  const std::string name = use_colour() ? "\x1b[1;31mpointskin:\x1b[0m" : "pointskin:";
  write_line(fmt::format("{} {}", name, one_line(story)));
}

void print_out_of_memory() noexcept {
  constexpr std::string_view kStory = "pointskin: out of memory; use a smaller --depth or fewer points\n";
  last_line_written = true;
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kStory.data(), kStory.size());
}

WarningsOf::WarningsOf(std::string file) : file_(std::move(file)), stories_(warnings()) { about = this; }
WarningsOf::~WarningsOf() { about = nullptr; }

void print_warning(const std::string& story) {
  const std::string line = one_line(story);
  std::vector<std::string>& told = about != nullptr ? about->stories_ : warnings();
  told.push_back(line);
  const bool names_file = about == nullptr || line.starts_with(about->file_ + ":");
  print_note("pointskin: warning: " + (names_file ? "" : about->file_ + ": ") + line);
}

const std::vector<std::string>& printed_warnings() { return about != nullptr ? about->stories_ : warnings(); }

void print_note(const std::string& text) {
  if (tells_for_all()) write_line(without_controls(text));
}

void write_stdout(const std::string& text) {
  if (!tells_for_all()) return;
  const std::string shown = without_controls(text);
  const bool written = std::fwrite(shown.data(), 1, shown.size(), stdout) == shown.size();
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
