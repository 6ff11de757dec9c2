// What the spaces' sweep() and its callers share.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::exec {

/// Base of a sweep's function in which every index takes part and nothing is prepared.
struct SweepAll {
  struct Nothing {};
  PSK_HD static bool takes_part(int /*i*/) { return true; }
  PSK_HD static Nothing prepare(int /*i*/) { return {}; }
};

/// A sweep's function whose rounds have different numbers of indices: f.indices(round) of them.
template <class F>
concept HasRoundsOfItsOwn = requires(const F& f) {
  f.indices(0);
};

/// Indices of a round of a sweep over n.
template <class F>
PSK_HD int indices_of_round(const F& f, int round, int n) {
  if constexpr (HasRoundsOfItsOwn<F>)
    return f.indices(round);
  else
    return n;
}

/// One round of a sweep: what for_each calls.
template <class F>
struct SweepRound {
  F f;
  int round;
  PSK_HD void operator()(std::int64_t index) const {
    const int i = static_cast<int>(index);
    if (f.takes_part(i)) f(round, i, f.prepare(i));
  }
};

}  // namespace pointskin::exec
