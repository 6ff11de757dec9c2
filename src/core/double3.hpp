// Vectors and matrices of doubles for kernels: every operation in one order, with + - * / and square roots alone.
#pragma once

#include <pointskin/vector.hpp>

#include "core/host_device.hpp"

namespace pointskin {

struct Double3 {
  double x = 0, y = 0, z = 0;
};

PSK_HD inline Double3 operator+(const Double3& a, const Double3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PSK_HD inline Double3 operator-(const Double3& a, const Double3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PSK_HD inline Double3 operator*(const Double3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
PSK_HD inline double dot(const Double3& a, const Double3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PSK_HD inline Double3 cross(const Double3& a, const Double3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

PSK_HD inline Double3 to_double(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
inline Double3 to_double(const Vec3d& v) { return {v[0], v[1], v[2]}; }
PSK_HD inline Vec3f to_float(const Double3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// A matrix by its columns: the images of the axes.
struct Matrix3 {
  Double3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

PSK_HD inline Double3 operator*(const Matrix3& m, const Double3& v) { return m.x * v.x + m.y * v.y + m.z * v.z; }
PSK_HD inline Matrix3 operator*(const Matrix3& a, const Matrix3& b) { return {a * b.x, a * b.y, a * b.z}; }

/// m + column row^T.
PSK_HD inline void add_outer(Matrix3& m, const Double3& column, const Double3& row) {
  m.x = m.x + column * row.x;
  m.y = m.y + column * row.y;
  m.z = m.z + column * row.z;
}

/// det(m) m^-T v: where areas with the normal v go, exact for the identity.
PSK_HD inline Double3 cofactor_times(const Matrix3& m, const Double3& v) {
  return cross(m.y, m.z) * v.x + cross(m.z, m.x) * v.y + cross(m.x, m.y) * v.z;
}

/// A symmetric matrix.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, yz = 0, xz = 0, xy = 0;
};

PSK_HD inline Symmetric3 operator+(const Symmetric3& a, const Symmetric3& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.yz + b.yz, a.xz + b.xz, a.xy + b.xy};
}
PSK_HD inline Symmetric3 operator*(const Symmetric3& a, double s) {
  return {a.xx * s, a.yy * s, a.zz * s, a.yz * s, a.xz * s, a.xy * s};
}
/// v v^T.
PSK_HD inline Symmetric3 outer(const Double3& v) {
  return {v.x * v.x, v.y * v.y, v.z * v.z, v.y * v.z, v.x * v.z, v.x * v.y};
}
PSK_HD inline Double3 operator*(const Symmetric3& m, const Double3& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

}  // namespace pointskin
