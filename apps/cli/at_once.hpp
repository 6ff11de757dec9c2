// Jobs of one run that do not depend on each other, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

#include "signals.hpp"

namespace pointskin::cli {

/// As many threads as were asked for, or as the machine has.
inline int thread_count(int asked) {
  return std::max(1, asked > 0 ? asked : static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls worker(i) once for every i in [begin, end), in order but `at_once` at a time. Each thread has a worker of its own,
/// of make_worker().
/// @throws what the call with the lowest i threw; no others begin then
template <class MakeWorker>
void run_at_once(std::size_t begin, std::size_t end, int at_once, const MakeWorker& make_worker) {
  if (begin >= end) return;
  std::vector<std::exception_ptr> failures(end);
  std::atomic<std::size_t> next{begin};
  const auto work = [&] {
    const InterruptScope scope;
    std::size_t i = begin;
    try {
      auto worker = make_worker();
      for (i = next++; i < end; i = next++) worker(i);
    } catch (...) {
      failures[std::min(i, end - 1)] = std::current_exception();
      next = end;
    }
  };
  std::vector<std::thread> helpers;
  try {
    for (int h = 1; h < at_once; ++h) helpers.emplace_back(work);
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): those that could be made do all the work
  }
  work();
  for (std::thread& helper : helpers) helper.join();
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace pointskin::cli
