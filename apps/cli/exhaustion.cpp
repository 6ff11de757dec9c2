#include "exhaustion.hpp"

#include <atomic>
#include <new>

namespace pointskin::cli {
namespace {

std::atomic<bool> has_run_out{false};

/// Called by operator new.
void remember_and_throw() {
  has_run_out.store(true);
  throw std::bad_alloc();
}

}  // namespace

void watch_memory() noexcept { std::set_new_handler(remember_and_throw); }

bool memory_ran_out() noexcept { return has_run_out.load(); }

}  // namespace pointskin::cli
