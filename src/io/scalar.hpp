// Numbers in binary and their byte orders.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include <pointskin/attribute.hpp>

namespace pointskin::io {

static_assert(std::endian::native == std::endian::little, "the binary readers and writers assume little endian");

/// The T at `from`, which need not be aligned; `swapped` if its bytes are big endian.
template <class T>
T load(const char* from, bool swapped) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swapped) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// `data` + `bytes`; null for null, which is where an empty vector begins.
inline const char* behind(const char* data, std::size_t bytes) { return data == nullptr ? nullptr : data + bytes; }

/// The integer of type `type` at `from`.
inline std::int64_t load_integer(AttributeType type, const char* from, bool swapped) {
  return visit_type(type, [&](auto tag) { return static_cast<std::int64_t>(load<decltype(tag)>(from, swapped)); });
}

/// `value` as float; what float cannot hold becomes infinite instead of undefined.
inline float to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (value > kLargest) return std::numeric_limits<float>::infinity();
  if (value < -kLargest) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value);
}

/// `value` as T: a float as to_float() has it, an integer as it is.
/// @param value  whole and within T if that is an integer
template <class T>
T narrowed(double value) {
  if constexpr (std::is_same_v<T, float>)
    return to_float(value);
  else
    return static_cast<T>(value);
}

}  // namespace pointskin::io
