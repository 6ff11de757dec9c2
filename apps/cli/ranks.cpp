#include "ranks.hpp"

#include <unistd.h>

#include <memory>

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

void let_the_first_tell() noexcept {
  if (!tells_for_all()) sleep(1);
}

int end_with_ranks(int exit_code) {
  if (ranks() && exit_code != 0) ranks()->end_all(exit_code);
  ranks().reset();  // waits for all
  return exit_code;
}

}  // namespace pointskin::cli
