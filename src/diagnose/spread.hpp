// A few of many things.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::diagnose {

/// `some` of `all` things, evenly spread: the i-th of them.
struct Spread {
  std::int64_t some = 0, all = 0;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return i * all / some; }
  /// The first of the `some` that is not before thing `begin`.
  [[nodiscard]] std::int64_t first_from(std::int64_t begin) const { return (begin * some + all - 1) / all; }
};

}  // namespace pointskin::diagnose
