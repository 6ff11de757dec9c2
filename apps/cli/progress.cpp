#include "progress.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace pointskin::cli {
namespace {

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace

std::string progress_text(const Progress& progress, double elapsed_s) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const std::string share = fmt::format("{:<8}{:3.0f} %", progress.phase, 100 * fraction);
  if (fraction < 0.01) return share;  // Too early for a guess.
  return fmt::format("{}, {} left", share, duration_text(elapsed_s * (1 - fraction) / fraction));
}

void ProgressLine::update(const Progress& progress) {
  if (!shown_) return;
  const double now_ms = watch_.ms();
  if (on_screen_ ? now_ms - last_ms_ < 100 : now_ms < 1000) return;
  last_ms_ = now_ms;
  on_screen_ = true;
  const std::string line = "\r\x1b[K" + progress_text(progress, now_ms / 1000);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!on_screen_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  on_screen_ = false;
}

}  // namespace pointskin::cli
