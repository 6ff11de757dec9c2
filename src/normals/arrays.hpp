// Small arrays to a space and back.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/algorithms.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"

namespace pointskin::normals {

template <class T, exec::Space Exec>
std::vector<T> to_host(Exec& ex, const exec::Buffer<T>& buffer) {
  std::vector<T> out(static_cast<std::size_t>(buffer.size()));
  copy_to_host(ex, buffer.cview(), out.data());
  return out;
}

template <class T, exec::Space Exec>
exec::Buffer<T> to_device(Exec& ex, const std::vector<T>& values) {
  auto out = exec::make_buffer<T>(ex, static_cast<std::int64_t>(values.size()));
  copy_to_device(ex, values.data(), out.view());
  return out;
}

/// Sums to add to.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> zeros(Exec& ex, std::int64_t n) {
  auto out = exec::make_buffer<std::uint64_t>(ex, n);
  exec::fill(ex, out.view(), std::uint64_t{0});
  return out;
}

}  // namespace pointskin::normals
