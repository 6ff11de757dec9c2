// Vectors of the host that are too large to be touched for the first time by one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "exec/cpu.hpp"

namespace pointskin::exec {

/// Has the system map the pages of [data, data + bytes) now, in parallel. A wish: without it they are mapped when they
/// are first written. Changes no byte.
void populate(Cpu& ex, void* data, std::size_t bytes);

/// values.reserve(size); the pages of new memory are mapped by all threads. The pool gives up as much of what it caches,
/// so that the process does not grow by both.
template <class T>
void reserve(Cpu& ex, std::vector<T>& values, std::size_t size) {
  if (size <= values.capacity()) return;
  ex.pool()->release_cached(static_cast<std::int64_t>(size * sizeof(T)));
  values.reserve(size);
  populate(ex, values.data(), size * sizeof(T));
}

/// values.resize(size), after reserve().
template <class T>
void resize(Cpu& ex, std::vector<T>& values, std::size_t size) {
  reserve(ex, values, size);
  values.resize(size);
}

/// The same for elements that are all written next: new ones are left as the memory came, where the standard library is
/// one whose vectors are known here. One thread that writes zeros takes longer than many that copy.
/// Source: `resizeWithoutInitialization` of folly (Apache 2.0), done by the public member of libstdc++'s base.
template <class T>
void resize_to_overwrite(std::vector<T>& values, std::size_t size) {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
#if defined(__GLIBCXX__) && !defined(_GLIBCXX_DEBUG) && !defined(_GLIBCXX_SANITIZE_VECTOR)
  using Base = std::_Vector_base<T, std::allocator<T>>;
  static_assert(std::is_base_of_v<Base, std::vector<T>>);
  values.reserve(size);
  Base& base = (Base&)values;  // NOLINT(google-readability-casting): the one cast that reaches a protected base
  base._M_impl._M_finish = base._M_impl._M_start + size;
#else
  values.resize(size);
#endif
}

/// The same; the pages of new memory are mapped by all threads.
template <class T>
void resize_to_overwrite(Cpu& ex, std::vector<T>& values, std::size_t size) {
  reserve(ex, values, size);
  resize_to_overwrite(values, size);
}

}  // namespace pointskin::exec
