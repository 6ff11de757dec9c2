// Vectors of the host that are too large to be touched for the first time by one thread.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/cpu.hpp"

namespace pointskin::exec {

/// Has the system map the pages of [data, data + bytes) now, in parallel. A wish: without it they are mapped when they
/// are first written. Changes no byte.
void populate(Cpu& ex, void* data, std::size_t bytes);

/// values.resize(size); the pages of new memory are mapped by all threads. The pool gives up as much of what it caches,
/// so that the process does not grow by both.
template <class T>
void resize(Cpu& ex, std::vector<T>& values, std::size_t size) {
  if (size > values.capacity()) {
    ex.pool()->release_cached(static_cast<std::int64_t>(size * sizeof(T)));
    values.reserve(size);
    populate(ex, values.data(), size * sizeof(T));
  }
  values.resize(size);
}

}  // namespace pointskin::exec
