#include "render/ticks.hpp"

#include <algorithm>
#include <cmath>

#include "core/format.hpp"

namespace pointskin::render_detail {
namespace {

/// The smallest of 1, 2, 5, 10 times a power of ten that makes at most `most` ticks.
double step_of(const ValueRange& range, int most) {
  const double least = (range.high - range.low) / most;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

int power_of_ten(double value) { return static_cast<int>(std::floor(std::log10(value) + 1e-9)); }

/// Large and small numbers lose their zeros, unless they would need many digits then, too.
int exponent_of(double largest, double step) {
  constexpr int kLarge = 5, kSmall = -3, kMostDigits = 4;
  const int power = power_of_ten(largest);
  const bool long_anyway = power - power_of_ten(step) >= kMostDigits;
  if ((power < kLarge && power >= kSmall) || (long_anyway && power >= 0 && power < 9)) return 0;
  return power >= 0 ? power / 3 * 3 : -((-power + 2) / 3 * 3);
}

}  // namespace

Ticks ticks_of(const ValueRange& range, int most) {
  const double step = step_of(range, most);
  Ticks ticks;
  ticks.exponent = exponent_of(std::max(std::abs(range.low), std::abs(range.high)), step);
  const double unit = std::pow(10.0, ticks.exponent);
  const int decimals = std::max(0, -power_of_ten(step / unit));
  const double slack = 1e-9 * (range.high - range.low);
  for (double k = std::ceil((range.low - slack) / step); k * step <= range.high + slack; ++k) {
    const double value = k == 0 ? 0 : k * step;  // no minus before a zero
    ticks.ticks.push_back({value, fmt::format("{:.{}f}", value / unit, decimals)});
  }
  return ticks;
}

}  // namespace pointskin::render_detail
