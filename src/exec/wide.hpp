// Wide vectors, chosen at run time: a range of indices in a function of its own, compiled for AVX2 beside the
// plain one (docs/decisions/0011-vectors-at-run-time.md).
#pragma once

#include <cstdint>

#include "core/float8.hpp"

namespace pointskin::exec {

/// True if this processor has wide vectors and the environment does not say POINTSKIN_VECTORS=plain.
bool has_wide_vectors();

template <class F>
void run_range_plain(const F& f, std::int64_t begin, std::int64_t end) {
  for (std::int64_t i = begin; i < end; ++i) f(i);
}

#if PSK_WIDE

/// Functors that can do the same with Float8: f.wide(i) has the effect of f(i), bit for bit.
template <class F>
concept Wide = requires(const F& f) {
  f.wide(std::int64_t{0});
};

/// Calls f.wide(i), where has_wide_vectors() is true. All that it calls is inlined, so all of it is compiled for AVX2,
/// which brings no fused multiply-adds.
template <Wide F>
__attribute__((target("avx2"), flatten)) void run_range_wide(const F& f, std::int64_t begin, std::int64_t end) {
  for (std::int64_t i = begin; i < end; ++i) f.wide(i);
}

#endif

/// Calls f(i), or what is the same, for every i in [begin, end).
template <class F>
void run_range(const F& f, std::int64_t begin, std::int64_t end) {
#if PSK_WIDE
  if constexpr (Wide<F>) {
    if (has_wide_vectors()) return run_range_wide(f, begin, end);
  }
#endif
  run_range_plain(f, begin, end);
}

}  // namespace pointskin::exec
