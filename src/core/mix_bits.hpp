// Hashes that decide the order of points which share their place.
#pragma once

#include <cstdint>
#include <cstring>

#include <pointskin/vector.hpp>

#include "core/host_device.hpp"

namespace pointskin {

/// What a hash starts from.
inline constexpr std::uint64_t kHashSeed = 0x9e3779b97f4a7c15ULL;

/// Mixes bits into a hash; equal bits give equal hashes. Source: the finaliser of MurmurHash3.
PSK_HD inline std::uint64_t mix_bits(std::uint64_t hash, std::uint32_t bits) {
  hash = (hash ^ bits) * 0xff51afd7ed558ccdULL;
  return hash ^ hash >> 33;
}

PSK_HD inline std::uint64_t mix_bits(std::uint64_t hash, float value) {
  std::uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return mix_bits(hash, bits);
}

PSK_HD inline std::uint64_t mix_vector(std::uint64_t hash, const Vec3f& v) {
  return mix_bits(mix_bits(mix_bits(hash, v.x), v.y), v.z);
}

}  // namespace pointskin
