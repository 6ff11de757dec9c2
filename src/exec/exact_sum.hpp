// Sums of doubles that have one result, in whatever order and in whatever parts their terms are added.
//
// A term is a whole number of units of 2^-fraction, cut towards zero; the sum of whole numbers of 128 bits is one. So the sum is at
// most n units away from that of the terms themselves. It is taken if that is at most 2^-40 of it; otherwise, and if a term is 2^95
// units or more, the unit is chosen again by the largest term. Both decisions depend on the set of terms alone. 2^32 terms have room:
// each is below 2^95 units, and all of them below 2^127.
// Parts that are summed on several GPUs, hosts or one after the other give the bits of one sum (docs/decisions/0055-exact-sums.md).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "exec/algorithms.hpp"

namespace pointskin::exec {

/// A whole number of units, of which the sum does not know how large they are.
struct ExactSum {
  __extension__ typedef __int128 Whole;

  Whole units = 0;
  std::int64_t outside = 0;  ///< terms that are too large for the unit, or not finite: they are not in it

  /// True if n terms are all in it, and what was cut off them is at most 2^-40 of the sum.
  [[nodiscard]] bool reliable(std::int64_t n) const {
    const Whole size = units < 0 ? -units : units;
    return outside == 0 && size >> 40 >= n;
  }

  /// The nearest double.
  [[nodiscard]] double value(int fraction) const { return std::ldexp(static_cast<double>(units), -fraction); }
};

/// Bits of the largest term.
inline constexpr int kExactTermBits = 95;

/// The unit, 2^-fraction, in which a term of this size has all its bits.
/// @param largest  finite, > 0
inline int fraction_for(double largest) {
  int exponent = 0;
  std::frexp(largest, &exponent);
  return kExactTermBits - std::max(exponent, std::numeric_limits<double>::min_exponent);
}

/// One term in units of 2^-fraction.
PSK_HD inline ExactSum exact_term(double value, int fraction) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto exponent = static_cast<int>(bits >> 52 & 0x7ff);
  const std::uint64_t mantissa = (bits & 0xfffffffffffff) | (exponent == 0 ? std::uint64_t{0} : std::uint64_t{1} << 52);
  const int shift = (exponent == 0 ? 1 : exponent) - 1075 + fraction;  // the term is mantissa 2^shift units
  ExactSum sum;
  if (exponent == 0x7ff || (mantissa != 0 && shift > kExactTermBits - 53)) {
    sum.outside = 1;
    return sum;
  }
  if (mantissa == 0 || shift <= -53) return sum;
  sum.units = shift < 0 ? ExactSum::Whole{mantissa >> -shift} : ExactSum::Whole{mantissa} << shift;
  if (bits >> 63 != 0) sum.units = -sum.units;
  return sum;
}

/// For reduce().
struct AddExactly {
  static constexpr bool kAnyOrder = true;
  PSK_HD ExactSum operator()(const ExactSum& a, const ExactSum& b) const {
    return {a.units + b.units, a.outside + b.outside};
  }
};

/// Of magnitudes. What is not a number counts as larger than all.
struct Largest {
  static constexpr bool kAnyOrder = true;
  PSK_HD double operator()(double a, double b) const { return a <= b || b != b ? b : a; }
};

namespace detail {

template <class F>
struct ExactTermOf {
  F f;
  int fraction;
  PSK_HD ExactSum operator()(std::int64_t i) const { return exact_term(f(i), fraction); }
};

template <class F>
struct MagnitudeOf {
  F f;
  PSK_HD double operator()(std::int64_t i) const {
    const double size = f(i);
    return size < 0 ? -size : size;
  }
};

}  // namespace detail

/// f(0) + ... + f(n-1) for n > 0, with the unit chosen by the largest term. NaN if a term is not finite. About 2 n calls of f; waits
/// two times.
template <Space Exec, class F>
double exact_sum(Exec& ex, const char* label, std::int64_t n, const F& f) {
  const auto largest = reduce<double>(ex, label, n, detail::MagnitudeOf<F>{f}, Largest{});
  if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
  if (largest == 0) return 0;
  const int fraction = fraction_for(largest);
  return reduce<ExactSum>(ex, label, n, detail::ExactTermOf<F>{f, fraction}, AddExactly{}).value(fraction);
}

/// The same with units of 2^-fraction where they do. About n calls of f; waits once where they do.
template <Space Exec, class F>
double exact_sum(Exec& ex, const char* label, std::int64_t n, const F& f, int fraction) {
  const auto sum = reduce<ExactSum>(ex, label, n, detail::ExactTermOf<F>{f, fraction}, AddExactly{});
  return sum.reliable(n) ? sum.value(fraction) : exact_sum(ex, label, n, f);
}

}  // namespace pointskin::exec
