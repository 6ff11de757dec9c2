// A pointer and a length that may travel into a kernel (std::span does not).
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/host_device.hpp"

namespace pointskin {

/// Non-owning view of `size` elements in whatever space they live. Trivially copyable; indexing is unchecked.
template <class T>
struct ArrayView {
  T* data = nullptr;
  std::int64_t size = 0;

  ArrayView() = default;
  PSK_HD ArrayView(T* first, std::int64_t count) : data(first), size(count) {}
  /// A view of T is a view of const T.
  template <class U>
  requires std::is_same_v<const U, T> PSK_HD ArrayView(ArrayView<U> other)  // NOLINT(google-explicit-constructor)
      : data(other.data), size(other.size) {}

  PSK_HD T& operator[](std::int64_t i) const { return data[i]; }
  PSK_HD T* begin() const { return data; }
  PSK_HD T* end() const { return data + size; }
  [[nodiscard]] PSK_HD bool empty() const { return size == 0; }
  [[nodiscard]] PSK_HD ArrayView part(std::int64_t first, std::int64_t count) const { return {data + first, count}; }
};

}  // namespace pointskin
