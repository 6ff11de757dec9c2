// Atomic operations on device and host memory. On integers only, and only such whose outcome does not depend on order. On GPUs of the
// whole system: several may share one launch (exec/gpus).
#pragma once

#include <atomic>
#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::exec {

/// Sets bits of a word that other threads set bits of, too. Looks first: most are set already.
PSK_HD inline void set_bits(std::uint32_t* word, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  if ((*static_cast<volatile std::uint32_t*>(word) & bits) != bits) atomicOr_system(word, bits);
#else
  const std::atomic_ref<std::uint32_t> shared(*word);
  if ((shared.load(std::memory_order_relaxed) & bits) != bits) shared.fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// Adds to a word that other threads add to, too.
PSK_HD inline void add(std::uint64_t* word, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd_system(reinterpret_cast<unsigned long long*>(word), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<std::uint64_t>(*word).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// The same. @returns what the word held before: a place of its own for each who adds.
PSK_HD inline std::uint32_t fetch_add(std::uint32_t* word, std::uint32_t value) {
#ifdef __CUDA_ARCH__
  return atomicAdd_system(word, value);
#else
  return std::atomic_ref<std::uint32_t>(*word).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Raises a word to `value` if it holds less; other threads may raise it, too.
PSK_HD inline void raise_to(std::uint64_t* word, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  if (*static_cast<volatile std::uint64_t*>(word) >= value) return;
  atomicMax_system(reinterpret_cast<unsigned long long*>(word), static_cast<unsigned long long>(value));
#else
  const std::atomic_ref<std::uint64_t> shared(*word);
  std::uint64_t held = shared.load(std::memory_order_relaxed);
  while (held < value && !shared.compare_exchange_weak(held, value, std::memory_order_relaxed)) {
  }
#endif
}

/// What is in a word that other threads may be changing.
PSK_HD inline std::int32_t load(const std::int32_t* word) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile std::int32_t*>(word);
#else
  return std::atomic_ref<std::int32_t>(*const_cast<std::int32_t*>(word)).load(std::memory_order_relaxed);
#endif
}

/// Writes `desired` if the word holds `expected`. @returns what it held before
PSK_HD inline std::int32_t compare_exchange(std::int32_t* word, std::int32_t expected, std::int32_t desired) {
#ifdef __CUDA_ARCH__
  return atomicCAS_system(word, expected, desired);
#else
  std::atomic_ref<std::int32_t>(*word).compare_exchange_strong(expected, desired, std::memory_order_relaxed);
  return expected;
#endif
}

}  // namespace pointskin::exec
