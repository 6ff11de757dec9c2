// Numbers in binary: their types, sizes and byte orders.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pointskin::io {

static_assert(std::endian::native == std::endian::little, "the binary readers and writers assume little endian");

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Calls f(T{}) with the C++ type of `type`.
template <class F>
decltype(auto) visit(Scalar type, F&& f) {
  switch (type) {
    case Scalar::int8:
      return f(std::int8_t{});
    case Scalar::uint8:
      return f(std::uint8_t{});
    case Scalar::int16:
      return f(std::int16_t{});
    case Scalar::uint16:
      return f(std::uint16_t{});
    case Scalar::int32:
      return f(std::int32_t{});
    case Scalar::uint32:
      return f(std::uint32_t{});
    case Scalar::float32:
      return f(float{});
    case Scalar::float64:
      break;
  }
  return f(double{});
}

inline std::size_t size_of(Scalar type) {
  return visit(type, [](auto tag) { return sizeof(tag); });
}

constexpr bool is_integer(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

/// The T at `from`, which need not be aligned; `swapped` if its bytes are big endian.
template <class T>
T load(const char* from, bool swapped) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swapped) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// The integer of type `type` at `from`.
inline std::int64_t load_integer(Scalar type, const char* from, bool swapped) {
  return visit(type, [&](auto tag) { return static_cast<std::int64_t>(load<decltype(tag)>(from, swapped)); });
}

/// `value` as float; what float cannot hold becomes infinite instead of undefined.
inline float to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (value > kLargest) return std::numeric_limits<float>::infinity();
  if (value < -kLargest) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value);
}

}  // namespace pointskin::io
