// Counting bits, on the host and on the device.
#pragma once

#include <bit>
#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin {

/// Number of set bits.
PSK_HD inline int count_bits(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return __popcll(bits);
#else
  return std::popcount(bits);
#endif
}

/// Position of the lowest set bit of a number that is not zero.
PSK_HD inline int lowest_bit(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return __ffsll(static_cast<long long>(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

}  // namespace pointskin
