// Wide vectors, chosen at run time: a range of indices in a function of its own, compiled for AVX2 beside the plain
// one.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

/// 1 where a function may be compiled for AVX2 beside the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__CUDACC__)
#define PSK_WIDE 1
#else
#define PSK_WIDE 0
#endif

namespace pointskin::exec {

/// Functors that compute with Float8 say so: `static constexpr bool kWide = true`.
template <class F>
concept Wide = F::kWide;

/// True if this processor has wide vectors and the environment does not say POINTSKIN_VECTORS=plain.
bool has_wide_vectors();

template <class F>
void run_range_plain(const F& f, std::int64_t begin, std::int64_t end) {
  for (std::int64_t i = begin; i < end; ++i) f(i);
}

/// The same bits as run_range_plain: AVX2 brings no fused multiply-adds, and a lane's operations keep their order. All
/// that f calls is inlined, so all of it is compiled for AVX2. Only where has_wide_vectors() is true.
#if PSK_WIDE
template <class F>
__attribute__((target("avx2"), flatten)) void run_range_wide(const F& f, std::int64_t begin, std::int64_t end) {
  for (std::int64_t i = begin; i < end; ++i) f(i);
}
#else
template <class F>
void run_range_wide(const F& f, std::int64_t begin, std::int64_t end) {
  run_range_plain(f, begin, end);
}
#endif

/// Calls f(i) for every i in [begin, end).
template <class F>
void run_range(const F& f, std::int64_t begin, std::int64_t end) {
  if constexpr (Wide<F>) {
    if (has_wide_vectors()) return run_range_wide(f, begin, end);
  }
  run_range_plain(f, begin, end);
}

}  // namespace pointskin::exec
