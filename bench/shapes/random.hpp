// Random numbers that are a function of (seed, index): the same for any order, thread count and standard library.
// SplitMix64: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace pointskin::bench {

/// One stream of numbers per (seed, index).
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t index) : state_(mix(mix(seed) ^ (index * 0x9e3779b97f4a7c15U))) {}

  std::uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15U); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Two independent standard normal numbers (Box & Muller 1958).
  std::array<double, 2> gaussian_pair() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace pointskin::bench
