// Middle and spread of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace pointskin::cli {

struct Spread {
  double median = 0, min = 0, max = 0;
};

/// @param values  at least one; the median of an even number is the mean of the two in the middle
inline Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {median, values.front(), values.back()};
}

}  // namespace pointskin::cli
