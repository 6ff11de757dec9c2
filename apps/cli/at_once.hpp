// Jobs of one run that do not depend on each other, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <pointskin/processors.hpp>

#include "signals.hpp"

namespace pointskin::cli {

/// As many threads as were asked for, or as the process may use processors; at most 256 unless it may use more.
inline int thread_count(int asked) {
  const int cores = usable_processors();
  return asked > 0 ? std::min(asked, std::max(256, cores)) : cores;
}

/// Calls worker(i) once for every i in [begin, end), in order but `at_once` at a time. Each thread has a worker of its own,
/// of make_worker().
/// @throws what the call with the lowest i threw, or else make_worker(); no others begin then
template <class MakeWorker>
void run_at_once(std::size_t begin, std::size_t end, int at_once, const MakeWorker& make_worker) {
  if (begin >= end) return;
  std::atomic<std::size_t> next{begin};
  std::mutex mutex;  // guards the failure
  std::exception_ptr failure;
  std::size_t failed = end;
  const auto work = [&] {
    const InterruptScope scope;
    std::size_t i = end;
    try {
      auto worker = make_worker();
      for (i = next++; i < end; i = next++) worker(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure || i < failed) {
        failure = std::current_exception();
        failed = i;
      }
      next = end;
    }
  };
  std::vector<std::thread> helpers;
  try {
    helpers.reserve(static_cast<std::size_t>(std::max(0, at_once - 1)));
    for (int h = 1; h < at_once; ++h) helpers.emplace_back(work);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): those that could be made do all the work
  }
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace pointskin::cli
