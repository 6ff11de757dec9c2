// Atomic operations on device and host memory. On integers only, and only such whose outcome does not depend on order.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::exec {

/// Sets bits of a word that other threads set bits of, too. Looks first: most are set already.
PSK_HD inline void set_bits(std::uint32_t* word, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  if ((*static_cast<volatile std::uint32_t*>(word) & bits) != bits) atomicOr(word, bits);
#else
  const std::atomic_ref<std::uint32_t> shared(*word);
  if ((shared.load(std::memory_order_relaxed) & bits) != bits) shared.fetch_or(bits, std::memory_order_relaxed);
#endif
}

}  // namespace pointskin::exec
