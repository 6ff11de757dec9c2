// Parallel work over blocks whose errors do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"

namespace pointskin::io {

/// Calls block(i) for every i in [0, count), in parallel. All blocks run even if some throw; then the error of the
/// lowest block is rethrown, so a garbled file is reported at the same place for any number of threads.
template <class F>
void run_in_order(exec::Cpu& ex, std::int64_t count, const F& block) {
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(count));
  ex.run_blocks(count, [&](std::int64_t i) {
    try {
      block(i);
    } catch (...) {
      failures[static_cast<std::size_t>(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

/// Joins per-block results in block order, freeing each as it goes.
template <class T>
std::vector<T> concatenate(std::vector<std::vector<T>>&& parts) {
  if (parts.size() == 1) return std::move(parts.front());
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (auto& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
    std::vector<T>().swap(part);
  }
  return all;
}

}  // namespace pointskin::io
