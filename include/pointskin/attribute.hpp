// Named scalars of points and vertices, kept in the type that their file gives them.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Types of scalars, as files have them. PLY has all but the integers of 64 bits.
enum class AttributeType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// Calls f(T{}) with the C++ type T of `type`.
template <class F>
constexpr decltype(auto) visit_type(AttributeType type, F&& f) {
  switch (type) {
    case AttributeType::int8:
      return f(std::int8_t{});
    case AttributeType::uint8:
      return f(std::uint8_t{});
    case AttributeType::int16:
      return f(std::int16_t{});
    case AttributeType::uint16:
      return f(std::uint16_t{});
    case AttributeType::int32:
      return f(std::int32_t{});
    case AttributeType::uint32:
      return f(std::uint32_t{});
    case AttributeType::int64:
      return f(std::int64_t{});
    case AttributeType::uint64:
      return f(std::uint64_t{});
    case AttributeType::float32:
      return f(float{});
    case AttributeType::float64:
      break;
  }
  return f(double{});
}

/// The types that an attribute may have.
template <class T>
concept AttributeScalar = std::same_as<T, std::int8_t> || std::same_as<T, std::uint8_t> ||
    std::same_as<T, std::int16_t> || std::same_as<T, std::uint16_t> || std::same_as<T, std::int32_t> ||
    std::same_as<T, std::uint32_t> || std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> ||
    std::same_as<T, float> || std::same_as<T, double>;

/// The AttributeType of T.
template <AttributeScalar T>
constexpr AttributeType type_of() {
  if constexpr (std::same_as<T, float>) return AttributeType::float32;
  if constexpr (std::same_as<T, double>) return AttributeType::float64;
  constexpr int kWidth = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
  return static_cast<AttributeType>(2 * kWidth + (std::unsigned_integral<T> ? 1 : 0));
}

/// Bytes of one value.
constexpr std::size_t size_of(AttributeType type) {
  return visit_type(type, [](auto tag) { return sizeof(tag); });
}

constexpr bool is_integer(AttributeType type) {
  return type != AttributeType::float32 && type != AttributeType::float64;
}

/// "int8", "uint8", ..., "float64".
const char* name_of(AttributeType type);

/// The smallest type that holds every value of both exactly. Where there is none, as nothing holds all of int64 and of
/// floats or of uint64, float64, which rounds whole numbers beyond 2^53.
AttributeType common_type(AttributeType a, AttributeType b);

/// The smallest type that holds every value of `type` and, besides, that there is none (NaN): float32 or float64.
AttributeType type_with_nan(AttributeType type);

/// True if the values of the attribute are names of things, which must not be averaged: there is no class 2.5 between
/// the classes 2 and 3. Vertices get the value of the nearest point.
///
/// | type                                     | label |
/// |------------------------------------------|-------|
/// | float32, float64                         | never |
/// | int8, int16, int32, uint32, int64, uint64 | always |
/// | uint8                                    | if the name sounds like a label's |
/// | uint16                                   | unless the name is that of a colour or an intensity and does not sound
///                                              like a label's |
///
/// A name sounds like a label's if it contains label, class, segment, instance, object, material, cluster or index, or
/// if one of its words is part or id; words end at capitals, digits and whatever is no letter. Names of colours and
/// intensities are red, green, blue, alpha, r, g, b, a, gray and grey, with diffuse_, ambient_, specular_ or emissive_
/// before them or not, and those that contain intensity, reflect, amplitude, luminance or brightness. Capitals do not
/// matter, nor does input_, which meshes set before names that they have themselves. O(length of the name).
bool is_label(const std::string& name, AttributeType type);

/// True if the name sounds like a label's (see is_label).
bool sounds_like_label(const std::string& name);

/// Values of one scalar type, one a point or vertex, in as many bytes as the type has.
///
/// A point may lack a value, as those of a scan without colours do that is merged with one that has them. Floats are
/// NaN there. Integers keep their type: a mask of a byte a value says which are missing; there is none as long as all
/// are there.
class AttributeValues {
 public:
  /// No values, of type float32.
  AttributeValues() = default;
  /// Copies cost as much as their bytes. @throws std::bad_alloc, after which an assignment leaves the old values
  AttributeValues(const AttributeValues& other);
  AttributeValues& operator=(const AttributeValues& other);
  AttributeValues(AttributeValues&&) noexcept = default;
  AttributeValues& operator=(AttributeValues&&) noexcept = default;
  ~AttributeValues() = default;

  /// Takes over `values`, all of which are there.
  template <AttributeScalar T>
  AttributeValues(std::vector<T> values) : values_(std::move(values)) {}  // NOLINT(google-explicit-constructor)

  /// `size` zeros.
  explicit AttributeValues(AttributeType type, std::size_t size = 0);

  /// `size` values that are missing.
  static AttributeValues missing(AttributeType type, std::size_t size);

  /// Takes over values of which some may be missing.
  /// @param mask  shape (n), 1 where an integer is missing; or (0). Floats say that themselves and have none.
  /// @throws Error usage if the shapes differ, or for a mask of floats
  static AttributeValues with_mask(AttributeValues values, std::vector<std::uint8_t> mask);

  [[nodiscard]] AttributeType type() const noexcept { return static_cast<AttributeType>(values_.index()); }
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// Bytes of the values and of the mask.
  [[nodiscard]] std::size_t bytes() const;

  /// The values as they are; those that are missing are 0, or NaN.
  /// @throws Error usage if they are not of type T
  template <AttributeScalar T>
  [[nodiscard]] const std::vector<T>& as() const& {
    require(type_of<T>());
    return std::get<std::vector<T>>(values_);
  }
  template <AttributeScalar T>
  [[nodiscard]] std::vector<T> as() && {
    return take<T>();
  }
  /// The same, to be changed. Missing ones stay missing.
  template <AttributeScalar T>
  [[nodiscard]] std::span<T> edit() {
    require(type_of<T>());
    return std::get<std::vector<T>>(values_);
  }
  /// The same, moved out of here, where none are left, nor a mask.
  /// @throws Error usage if they are not of type T
  template <AttributeScalar T>
  [[nodiscard]] std::vector<T> take() {
    require(type_of<T>());
    mask_.clear();
    return std::exchange(std::get<std::vector<T>>(values_), {});
  }
  /// Calls f(const std::vector<T>&) with the values.
  template <class F>
  decltype(auto) visit(F&& f) const {
    return std::visit(std::forward<F>(f), values_);
  }

  /// The value of point i < size(); NaN where it is missing. Exact but for whole numbers beyond 2^53.
  [[nodiscard]] double at(std::size_t i) const;
  [[nodiscard]] bool is_missing(std::size_t i) const;
  /// True if an integer is missing. Floats are not looked through.
  [[nodiscard]] bool has_mask() const noexcept { return !mask_.empty(); }
  /// Shape (n) or (0): 1 where an integer is missing.
  [[nodiscard]] const std::vector<std::uint8_t>& mask() const noexcept { return mask_; }
  /// Takes the value of point i < size() away.
  void set_missing(std::size_t i);

  /// Values beyond the present ones are missing.
  void resize(std::size_t size);
  /// Leaves the values where `keep`, of shape (n), is true, in their order.
  void keep_where(const std::vector<bool>& keep);
  /// The values of these points, each in [0, n).
  [[nodiscard]] AttributeValues gather(const std::vector<std::int64_t>& points) const;
  /// Adds `more` behind the values; both become the common type.
  void append(const AttributeValues& more);
  /// In another type: rounded to the nearest and cut off at its ends where that does not hold them. Integers that are
  /// missing become NaN in floats, and NaN is missing in integers.
  [[nodiscard]] AttributeValues converted(AttributeType to) const;

  /// The same type and values, missing at the same places. NaN equals nothing.
  friend bool operator==(const AttributeValues&, const AttributeValues&) = default;

 private:
  /// In the order of AttributeType.
  using Storage =
      std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                   std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                   std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;

  void require(AttributeType asked) const {
    if (asked != type()) fail_type(asked);
  }
  [[noreturn]] void fail_type(AttributeType asked) const;
  /// Frees the mask if nothing is missing any more.
  void drop_empty_mask();

  Storage values_ = std::vector<float>();
  std::vector<std::uint8_t> mask_;  ///< (n) or (0)
};

/// A named scalar per point or vertex, for example "red", "density", "label".
struct Attribute {
  std::string name;
  AttributeValues values;  ///< shape (n)

  /// The type in the file that it was read from; it is written back in the same.
  [[nodiscard]] AttributeType type() const noexcept { return values.type(); }
  [[nodiscard]] bool is_label() const { return pointskin::is_label(name, type()); }
};

}  // namespace pointskin
