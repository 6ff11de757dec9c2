// How work and memory are cut into shares, one a GPU. Nothing here needs a GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/host_device.hpp"

namespace pointskin::exec::gpus {

/// [0, n) in `count` contiguous shares whose sizes differ by one at most. n < 2^57.
struct Shares {
  std::int64_t n;
  int count;

  [[nodiscard]] PSK_HD std::int64_t begin(int share) const { return n * share / count; }
  [[nodiscard]] PSK_HD std::int64_t end(int share) const { return begin(share + 1); }
  [[nodiscard]] PSK_HD std::int64_t size(int share) const { return end(share) - begin(share); }
};

/// At least `bytes`.
inline std::size_t whole_pages(std::size_t bytes, std::size_t page) { return (bytes + page - 1) / page * page; }

/// True if a block of `held` bytes may stand in for a new one of `wanted`: its shares begin a little later than those of an array
/// of that size, so that a part of every share, at most an eighth, lies on the GPU before.
inline bool may_stand_in(std::size_t held, std::size_t wanted) { return held >= wanted && held - wanted <= wanted / 8; }

}  // namespace pointskin::exec::gpus
