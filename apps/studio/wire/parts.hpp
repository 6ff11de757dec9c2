// Work over indices, cut into parts for a few threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

#include <pointskin/processors.hpp>

namespace pointskin::studio::wire {

/// Calls f(begin, end) for parts of [0, size), each index once, in threads of their own where there is enough to do.
/// @param threads  at most; 0: as many as the process may use, but no more than copying can use
template <class F>
void for_parts(std::size_t size, int threads, const F& f) {
  constexpr std::size_t kLeast = 32'768, kMostThreads = 8;
  const std::size_t allowed =
      threads > 0 ? static_cast<std::size_t>(threads) : static_cast<std::size_t>(usable_processors());
  const std::size_t parts = std::clamp(std::min({allowed, kMostThreads, size / kLeast}), std::size_t{1}, kMostThreads);
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < parts; ++i)
    others.emplace_back([&f, i, parts, size] { f(size * i / parts, size * (i + 1) / parts); });
  f(std::size_t{0}, size / parts);
}

}  // namespace pointskin::studio::wire
