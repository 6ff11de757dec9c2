// A sum for every index, in parts that a GPU gives to threads side by side: where there are few indices, more threads
// wait for memory at the same time.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::exec {

/// What for_each_by_lanes does, on one thread. F has kLanes (a power of two, at most 32), a trivially copyable type Sum
/// of members of 4 or 8 bytes with `+`, part(i, lane) and finish(i, sum).
template <class F>
struct SumOfLanes {
  F f;
  PSK_HD void operator()(std::int64_t i) const {
    typename F::Sum sums[F::kLanes];
    for (int lane = 0; lane < F::kLanes; ++lane) sums[lane] = f.part(i, lane);
    for (int step = 1; step < F::kLanes; step *= 2)
      for (int lane = 0; lane < F::kLanes; lane += 2 * step) sums[lane] = sums[lane] + sums[lane + step];
    f.finish(i, sums[0]);
  }
};

}  // namespace pointskin::exec
