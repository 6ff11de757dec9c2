#pragma once

#include <cstdint>
#include <iterator>

#include "core/host_device.hpp"

namespace pointskin::exec {

/// 0, 1, 2, ... as an iterator.
struct CountingIterator {
  using value_type = std::int32_t;
  using reference = std::int32_t;
  using pointer = const std::int32_t*;
  using difference_type = std::int64_t;
  using iterator_category = std::random_access_iterator_tag;

  std::int64_t at = 0;
  PSK_HD std::int32_t operator*() const { return static_cast<std::int32_t>(at); }
  PSK_HD std::int32_t operator[](std::int64_t i) const { return static_cast<std::int32_t>(at + i); }
  PSK_HD CountingIterator operator+(std::int64_t i) const { return {at + i}; }
  PSK_HD CountingIterator& operator+=(std::int64_t i) {
    at += i;
    return *this;
  }
};

}  // namespace pointskin::exec
