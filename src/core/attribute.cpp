#include <pointskin/attribute.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/compact.hpp"

namespace pointskin {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// `value` as T: rounded, and cut off at T's ends. Not for NaN in integers.
template <class T, class From>
T cut_off(From value) {
  if constexpr (std::is_floating_point_v<T>) {
    const auto wide = static_cast<double>(value);
    if (std::abs(wide) > static_cast<double>(std::numeric_limits<T>::max()))
      return std::copysign(std::numeric_limits<T>::infinity(), static_cast<T>(wide > 0 ? 1 : -1));
    return static_cast<T>(value);
  } else if constexpr (std::is_integral_v<From>) {
    if (std::cmp_less(value, std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
    if (std::cmp_greater(value, std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
    return static_cast<T>(value);
  } else {
    const double rounded = std::round(static_cast<double>(value));
    if (rounded <= static_cast<double>(std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
    if (rounded >= static_cast<double>(std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
    return static_cast<T>(rounded);
  }
}

template <class T>
std::vector<T> gathered(const std::vector<T>& values, const std::vector<std::int64_t>& points) {
  std::vector<T> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result[i] = values[static_cast<std::size_t>(points[i])];
  return result;
}

}  // namespace

const char* name_of(AttributeType type) {
  constexpr std::array kNames{"int8",   "uint8", "int16",  "uint16",  "int32",
                              "uint32", "int64", "uint64", "float32", "float64"};
  return kNames[static_cast<std::size_t>(type)];
}

AttributeType type_with_nan(AttributeType type) {
  return type == AttributeType::float32 || size_of(type) <= 2 ? AttributeType::float32 : AttributeType::float64;
}

AttributeType common_type(AttributeType a, AttributeType b) {
  if (a == b) return a;
  if (!is_integer(a) || !is_integer(b)) {
    const bool narrow = type_with_nan(a) == AttributeType::float32 && type_with_nan(b) == AttributeType::float32;
    return narrow ? AttributeType::float32 : AttributeType::float64;
  }
  const auto is_signed = [](AttributeType type) { return static_cast<int>(type) % 2 == 0; };
  if (is_signed(a) == is_signed(b)) return std::max(a, b);
  const AttributeType with_sign = is_signed(a) ? a : b;
  const AttributeType without = is_signed(a) ? b : a;
  if (with_sign > without) return with_sign;
  // The next signed type holds all of an unsigned one.
  return without == AttributeType::uint64 ? AttributeType::float64
                                          : static_cast<AttributeType>(static_cast<int>(without) + 1);
}

AttributeValues::AttributeValues(AttributeType type, std::size_t size) {
  static_assert(type_of<std::int8_t>() == AttributeType::int8 && type_of<std::uint64_t>() == AttributeType::uint64 &&
                type_of<double>() == AttributeType::float64);
  visit_type(type, [&](auto tag) { values_ = std::vector<decltype(tag)>(size); });
}

// The values are copied before the variant takes them. Where memory runs out in its own copy, that of libstdc++ 12 destroys
// what was never made.
AttributeValues::AttributeValues(const AttributeValues& other) : mask_(other.mask_) {
  other.visit([&](const auto& values) { values_ = std::remove_cvref_t<decltype(values)>(values); });
}

AttributeValues& AttributeValues::operator=(const AttributeValues& other) { return *this = AttributeValues(other); }

AttributeValues AttributeValues::missing(AttributeType type, std::size_t size) {
  AttributeValues values(type);
  values.resize(size);
  return values;
}

AttributeValues AttributeValues::with_mask(AttributeValues values, std::vector<std::uint8_t> mask) {
  if (!mask.empty() && (mask.size() != values.size() || !is_integer(values.type())))
    throw Error(ErrorCode::usage, "a mask of missing values is for integers, and has a byte for every one of them");
  values.mask_ = std::move(mask);
  values.drop_empty_mask();
  for (std::size_t i = 0; i < values.mask_.size(); ++i)
    if (values.mask_[i] != 0) values.set_missing(i);
  return values;
}

std::size_t AttributeValues::size() const {
  return visit([](const auto& values) { return values.size(); });
}

std::size_t AttributeValues::bytes() const { return size() * size_of(type()) + mask_.size(); }

double AttributeValues::at(std::size_t i) const {
  if (has_mask() && mask_[i] != 0) return kNan;
  return visit([i](const auto& values) { return static_cast<double>(values[i]); });
}

bool AttributeValues::is_missing(std::size_t i) const { return std::isnan(at(i)); }

void AttributeValues::set_missing(std::size_t i) {
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_floating_point_v<T>) {
          values[i] = std::numeric_limits<T>::quiet_NaN();
        } else {
          mask_.resize(values.size());
          mask_[i] = 1;
          values[i] = 0;
        }
      },
      values_);
}

void AttributeValues::resize(std::size_t size) {
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_floating_point_v<T>) {
          values.resize(size, std::numeric_limits<T>::quiet_NaN());
        } else {
          if (size > values.size() || has_mask()) {
            mask_.resize(values.size());
            mask_.resize(size, 1);
          }
          values.resize(size);
        }
      },
      values_);
  drop_empty_mask();
}

void AttributeValues::keep_where(const std::vector<bool>& keep) {
  std::visit([&](auto& values) { compact(values, keep); }, values_);
  if (!has_mask()) return;
  compact(mask_, keep);
  drop_empty_mask();
}

AttributeValues AttributeValues::gather(const std::vector<std::int64_t>& points) const {
  AttributeValues result = visit([&](const auto& values) { return AttributeValues(gathered(values, points)); });
  if (has_mask()) result.mask_ = gathered(mask_, points);
  result.drop_empty_mask();
  return result;
}

void AttributeValues::append(const AttributeValues& more) {
  const AttributeType type = common_type(this->type(), more.type());
  if (type != this->type()) *this = converted(type);
  if (type != more.type()) return append(more.converted(type));
  if (has_mask() || more.has_mask()) {
    mask_.resize(size());
    mask_.insert(mask_.end(), more.mask_.begin(), more.mask_.end());
    mask_.resize(size() + more.size());
  }
  std::visit(
      [&](auto& values) {
        const auto& others = std::get<std::decay_t<decltype(values)>>(more.values_);
        values.insert(values.end(), others.begin(), others.end());
      },
      values_);
}

AttributeValues AttributeValues::converted(AttributeType to) const {
  if (to == type()) return *this;
  AttributeValues result(to, size());
  visit([&](const auto& from) {
    std::visit(
        [&](auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          for (std::size_t i = 0; i < from.size(); ++i)
            if (from[i] == from[i]) values[i] = cut_off<T>(from[i]);
        },
        result.values_);
  });
  if (has_mask() || !is_integer(type()))
    for (std::size_t i = 0; i < size(); ++i)
      if (is_missing(i)) result.set_missing(i);
  return result;
}

void AttributeValues::fail_type(AttributeType asked) const {
  throw Error(ErrorCode::usage, std::string("the values are ") + name_of(type()) + ", not " + name_of(asked));
}

void AttributeValues::drop_empty_mask() {
  if (std::all_of(mask_.begin(), mask_.end(), [](std::uint8_t m) { return m == 0; }))
    std::vector<std::uint8_t>().swap(mask_);
}

}  // namespace pointskin
