#pragma once

#include <cstddef>
#include <vector>

namespace pointskin {

/// Leaves the values where `keep`, of the same shape, is true, in their order.
template <class T>
void compact(std::vector<T>& values, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (keep[i]) values[kept++] = values[i];
  values.resize(kept);
}

}  // namespace pointskin
