// Matrices of doubles for kernels: every operation in one order, with + - * / alone.
#pragma once

#include "core/vec3.hpp"

namespace pointskin {

/// A matrix by its columns: the images of the axes.
struct Matrix3 {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

PSK_HD inline Vec3d operator*(const Matrix3& m, const Vec3d& v) { return m.x * v.x + m.y * v.y + m.z * v.z; }
PSK_HD inline Matrix3 operator*(const Matrix3& a, const Matrix3& b) { return {a * b.x, a * b.y, a * b.z}; }

/// m + column row^T.
PSK_HD inline void add_outer(Matrix3& m, const Vec3d& column, const Vec3d& row) {
  m.x = m.x + column * row.x;
  m.y = m.y + column * row.y;
  m.z = m.z + column * row.z;
}

/// det(m) m^-T v: where areas with the normal v go, exact for the identity.
PSK_HD inline Vec3d cofactor_times(const Matrix3& m, const Vec3d& v) {
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
PSK_HD inline Symmetric3 outer(const Vec3d& v) {
  return {v.x * v.x, v.y * v.y, v.z * v.z, v.y * v.z, v.x * v.z, v.x * v.y};
}
PSK_HD inline Vec3d operator*(const Symmetric3& m, const Vec3d& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

}  // namespace pointskin
