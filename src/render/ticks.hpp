// Round numbers along a scale.
#pragma once

#include <pointskin/render.hpp>

#include <string>
#include <vector>

namespace pointskin::render_detail {

struct Tick {
  double value = 0;
  std::string label;
};

/// Ticks at multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  std::vector<Tick> ticks;  ///< ascending, within the range
  int exponent = 0;         ///< labels are to be multiplied by 10^exponent
};

/// @param range  low < high @param most  ticks, at least 2
Ticks ticks_of(const ValueRange& range, int most);

}  // namespace pointskin::render_detail
