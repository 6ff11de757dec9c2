// Eight floats at once, one for each corner or cell of a brick, in the order of the slots (x is the highest bit).
//
// Vectors of the language's extension in g++ and clang. Every operation works lane by lane, so a lane gets the bits
// that a float would. For code that is compiled for AVX2 (exec/wide.hpp): without it compilers take vectors of 32 bytes
// apart, which is slower than floats one by one. nvcc does not see them.
#pragma once

#include <cstdint>
#include <cstring>

/// 1 where the compiler can make functions for AVX2 beside those for the plain processor. Sanitizer builds do not.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__CUDACC__) && !defined(POINTSKIN_PLAIN)
#define PSK_WIDE 1
#else
#define PSK_WIDE 0
#endif

/// A Float8 may be passed in a register or in memory, depending on what the caller is compiled for. So no function that
/// takes or returns one may be left as a call.
#if PSK_WIDE
#define PSK_INLINE inline __attribute__((always_inline))
#else
#define PSK_INLINE inline
#endif

#if PSK_WIDE

namespace pointskin {

using Float8 = float __attribute__((vector_size(32)));
using Mask8 = std::int32_t __attribute__((vector_size(32)));  ///< -1 or 0 in each lane

/// a where the mask is set, b elsewhere.
PSK_INLINE Float8 select(const Mask8& mask, const Float8& a, const Float8& b) { return mask ? a : b; }

/// Lane s is set where bit s of `bits` is.
PSK_INLINE Mask8 mask_of_bits(int bits) {
  constexpr Mask8 kBit = {1, 2, 4, 8, 16, 32, 64, 128};
  return (kBit & bits) != 0;
}

namespace detail {
template <int Axis>
PSK_INLINE Float8 between(const Float8& lower, const Float8& upper) {
  if constexpr (Axis == 0) return __builtin_shufflevector(lower, upper, 4, 5, 6, 7, 8, 9, 10, 11);
  if constexpr (Axis == 1) return __builtin_shufflevector(lower, upper, 2, 3, 8, 9, 6, 7, 12, 13);
  if constexpr (Axis == 2) return __builtin_shufflevector(lower, upper, 1, 8, 3, 10, 5, 12, 7, 14);
}
}  // namespace detail

/// Column k of 8 rows of 4 floats in out[k].
PSK_INLINE void load_columns(const float* rows, Float8 (&out)[4]) {
  Float8 pair[4];  // rows 0 and 1, 2 and 3, ...
  std::memcpy(pair, rows, sizeof pair);
  const Float8 row04 = __builtin_shufflevector(pair[0], pair[2], 0, 1, 2, 3, 8, 9, 10, 11);
  const Float8 row15 = __builtin_shufflevector(pair[0], pair[2], 4, 5, 6, 7, 12, 13, 14, 15);
  const Float8 row26 = __builtin_shufflevector(pair[1], pair[3], 0, 1, 2, 3, 8, 9, 10, 11);
  const Float8 row37 = __builtin_shufflevector(pair[1], pair[3], 4, 5, 6, 7, 12, 13, 14, 15);
  const Float8 low01 = __builtin_shufflevector(row04, row15, 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 low23 = __builtin_shufflevector(row26, row37, 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 high01 = __builtin_shufflevector(row04, row15, 2, 10, 3, 11, 6, 14, 7, 15);
  const Float8 high23 = __builtin_shufflevector(row26, row37, 2, 10, 3, 11, 6, 14, 7, 15);
  out[0] = __builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15);
  out[2] = __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13);
  out[3] = __builtin_shufflevector(high01, high23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// 8 floats, of any alignment.
PSK_INLINE Float8 load8(const float* from) {
  Float8 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
PSK_INLINE void store8(const Float8& value, float* to) { std::memcpy(to, &value, sizeof value); }

/// The 8 values half way between two bricks that are neighbours along an axis: the upper half of `lower`, then the
/// lower half of `upper`.
template <int Axis>
PSK_INLINE Float8 between(const Float8& lower, const Float8& upper) {
  return detail::between<Axis>(lower, upper);
}

}  // namespace pointskin

#endif
