#include <algorithm>

#include "deform/spacing.hpp"

namespace pointskin::deform {

SpacingRatios spacing_ratios(const std::vector<float>& now, const std::vector<float>& at_rest,
                             const std::vector<std::int32_t>& parents) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const float before = at_rest[static_cast<std::size_t>(parents[i])];
    if (before > 0) ratios.push_back(static_cast<double>(now[i]) / static_cast<double>(before));
  }
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
  };
  return {at(0.05), at(0.5), at(0.95)};
}

}  // namespace pointskin::deform
