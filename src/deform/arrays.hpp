// Arrays made of others.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/algorithms.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"

namespace pointskin::deform {

template <class T, exec::Space Exec>
exec::Buffer<T> on_device(Exec& ex, const std::vector<T>& from) {
  auto to = exec::make_buffer<T>(ex, static_cast<std::int64_t>(from.size()));
  if (!from.empty()) copy_to_device(ex, from.data(), to.view());
  return to;
}

template <class T, exec::Space Exec>
exec::Buffer<T> gathered(Exec& ex, const exec::Buffer<T>& from, const exec::Buffer<std::int32_t>& index) {
  auto to = exec::make_buffer<T>(ex, index.size());
  exec::gather(ex, from.cview(), index.cview(), to.view());
  return to;
}

}  // namespace pointskin::deform
