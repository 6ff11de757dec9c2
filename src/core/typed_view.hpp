// Values whose type is known when the program runs, as functors see them. The type is the same for all of them: a
// branch on it costs little beside the memory that is read.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

#include <pointskin/attribute.hpp>

#include "core/host_device.hpp"
#include "core/mix_bits.hpp"

namespace pointskin {

/// Non-owning view of `size` values in whatever space they live. Trivially copyable; indexing is unchecked.
struct TypedView {
  AttributeType type = AttributeType::float32;
  const void* data = nullptr;             ///< (n) of the type, aligned for it
  const std::uint8_t* missing = nullptr;  ///< (n) 1 where an integer is missing; null: all are there
  std::int64_t size = 0;

  template <class T>
  [[nodiscard]] PSK_HD T value(std::int64_t i) const {
    return static_cast<const T*>(data)[i];
  }

  [[nodiscard]] PSK_HD bool is_missing(std::int64_t i) const { return missing != nullptr && missing[i] != 0; }

  /// The value, NaN where it is missing. Exact but for whole numbers beyond 2^53.
  PSK_HD double operator[](std::int64_t i) const {
    if (is_missing(i)) return std::numeric_limits<double>::quiet_NaN();
    return visit_type(type, [&](auto tag) { return static_cast<double>(value<decltype(tag)>(i)); });
  }

  /// The value as float, which is exact for float32 and for integers up to 16 bits.
  [[nodiscard]] PSK_HD float as_float(std::int64_t i) const {
    if (is_missing(i)) return std::numeric_limits<float>::quiet_NaN();
    return visit_type(type, [&](auto tag) { return static_cast<float>(value<decltype(tag)>(i)); });
  }

  /// The bits of the value, and zeros above them.
  [[nodiscard]] PSK_HD std::uint64_t bits(std::int64_t i) const {
    return visit_type(type, [&](auto tag) {
      const auto v = value<decltype(tag)>(i);
      std::uint64_t all = 0;
      memcpy(&all, &v, sizeof v);
      return all;
    });
  }

  /// Mixes the value into a hash: as float where that is exact, else all its bits.
  [[nodiscard]] PSK_HD std::uint64_t mixed_into(std::uint64_t hash, std::int64_t i) const {
    if (is_missing(i) || type == AttributeType::float32 || size_of(type) <= 2) return mix_bits(hash, as_float(i));
    const std::uint64_t all = bits(i);
    return mix_bits(mix_bits(hash, static_cast<std::uint32_t>(all)), static_cast<std::uint32_t>(all >> 32));
  }
};

/// `value` as T, rounded half up and cut off at T's ends; 0 for NaN.
/// @tparam T  an unsigned integer of up to 16 bits
template <class T>
PSK_HD T rounded_to(float value) {
  constexpr auto kHighest = static_cast<float>(std::numeric_limits<T>::max());
  return value > 0 ? static_cast<T>((value < kHighest ? value : kHighest) + 0.5F) : T{0};
}

/// Where functors write values to that they have computed. Those are of the types float32, float64, uint8 and uint16:
/// all others are copied.
struct TypedOutput {
  AttributeType type = AttributeType::float32;
  void* data = nullptr;  ///< (n)

  /// Stores `value`, in integers as rounded_to() has it.
  PSK_HD void store(std::int64_t i, double value) const {
    if (type == AttributeType::float32) static_cast<float*>(data)[i] = static_cast<float>(value);
    if (type == AttributeType::float64) static_cast<double*>(data)[i] = value;
    if (type == AttributeType::uint8)
      static_cast<std::uint8_t*>(data)[i] = rounded_to<std::uint8_t>(static_cast<float>(value));
    if (type == AttributeType::uint16)
      static_cast<std::uint16_t*>(data)[i] = rounded_to<std::uint16_t>(static_cast<float>(value));
  }
};

}  // namespace pointskin
