#include "scale/block_cuts.hpp"

#include <algorithm>
#include <numeric>

namespace pointskin::scale {
namespace {

/// Greedy runs of at most `most`, which is no less than the largest load.
std::vector<std::int64_t> runs_of(std::span<const std::int64_t> loads, std::int64_t most) {
  std::vector<std::int64_t> begins{0};
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (loads[i] > most - sum) {
      begins.push_back(static_cast<std::int64_t>(i));
      sum = 0;
    }
    sum += loads[i];
  }
  return begins;
}

}  // namespace

std::vector<std::int64_t> cut_evenly(std::span<const std::int64_t> loads, int blocks) {
  const std::int64_t total = std::accumulate(loads.begin(), loads.end(), std::int64_t{0});
  const std::int64_t largest = loads.empty() ? 0 : *std::max_element(loads.begin(), loads.end());
  std::int64_t low = std::max(largest, total / blocks);
  std::int64_t high = std::max(low, total);
  const auto wanted = static_cast<std::size_t>(blocks);
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (runs_of(loads, middle).size() <= wanted)
      high = middle;
    else
      low = middle + 1;
  }
  std::vector<std::int64_t> begins = runs_of(loads, high);
  begins.resize(wanted + 1, static_cast<std::int64_t>(loads.size()));
  return begins;
}

}  // namespace pointskin::scale
