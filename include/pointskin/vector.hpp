// Small fixed-size vectors used at the library's face.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Three numbers without padding, initialised as {x, y, z}, 0 where nothing is said. All functions below are constexpr,
/// take constant time and do their operations in the order written here.
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  /// Component `axis`, 0, 1 or 2.
  constexpr T& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr const T& operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr Vec3& operator+=(const Vec3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3& operator-=(const Vec3& b) { return *this = {x - b.x, y - b.y, z - b.z}; }

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// 12 bytes: the layout of packed xyz data in files.
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

static_assert(sizeof(Vec3f) == 12 && std::is_trivially_copyable_v<Vec3f> && std::is_aggregate_v<Vec3f>);
static_assert(sizeof(Vec3d) == 24 && std::is_trivially_copyable_v<Vec3d> && std::is_aggregate_v<Vec3d>);

template <class T>
constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
constexpr Vec3<T> operator*(const Vec3<T>& a, std::type_identity_t<T> s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T>
constexpr Vec3<T> operator*(std::type_identity_t<T> s, const Vec3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
constexpr Vec3<T> operator/(const Vec3<T>& a, std::type_identity_t<T> s) {
  return {a.x / s, a.y / s, a.z / s};
}

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// The vector product: right-handed, as long as the area between a and b.
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T squared_length(const Vec3<T>& a) {
  return dot(a, a);
}

/// Corner ids of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<std::int32_t, 3>;

}  // namespace pointskin
