#include "ranks.hpp"

#include <unistd.h>

#include <memory>

#include "signals.hpp"

namespace pointskin::cli {
namespace {

/// Null before the ranks are started, and where there are none.
std::unique_ptr<Ranks>& ranks() {
  static std::unique_ptr<Ranks> all;
  return all;
}

}  // namespace

Ranks* launched_ranks() {
  static const bool started = [] {
    ranks() = ranks_of_launcher();
    return true;
  }();
  (void)started;
  return ranks().get();
}

bool is_one_of_ranks() noexcept {
  static const bool is_one = launched_rank().size > 1;
  return is_one;
}

bool tells_for_all() noexcept {
  static const bool is_first = launched_rank().rank == 0;
  return is_first;
}

bool tells_of(ErrorCode error) noexcept {
  if (tells_for_all()) return true;
  if (error == ErrorCode::usage) return false;
  constexpr int kLooks = 60, kMicroseconds = 50'000;
  for (int look = 0; look < kLooks && !interrupted(); ++look) usleep(kMicroseconds);
  return !interrupted();
}

int end_with_ranks(int exit_code) {
  if (ranks() && exit_code != 0) {
    constexpr int kMicroseconds = 200'000;
    ignore_interrupts();    // by which the launcher ends this process, too
    usleep(kMicroseconds);  // until it has passed on what was told
    ranks()->end_all(exit_code);
  }
  ranks().reset();  // waits for all
  return exit_code;
}

}  // namespace pointskin::cli
