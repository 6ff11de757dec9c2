#include "mesh/exact_sign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/vec3.hpp"

namespace pointskin::mesh_detail {
namespace {

/// Half an ulp of 1.
constexpr double kEpsilon = 0x1p-53;

/// Relative errors of the rounded determinants, as shares of the same sums with all terms positive (Shewchuk 1997, A
/// in figures 21 and 18 of the paper).
constexpr double kPlaneError = (7 + 56 * kEpsilon) * kEpsilon;
constexpr double kTurnError = (3 + 16 * kEpsilon) * kEpsilon;

int sign_of(double x) { return (x > 0) - (x < 0); }

/// A sum of up to N doubles without any error: parts that do not overlap, none of them 0, by ascending size.
/// Source: grow-expansion with the elimination of zeros (Shewchuk 1997, figure 6, theorem 10).
template <std::size_t N>
class ExactSum {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = value + parts_[i];
      const double of_part = sum - value;
      const double error = (value - (sum - of_part)) + (parts_[i] - of_part);
      if (error != 0) parts_[kept++] = error;
      value = sum;
    }
    if (value != 0) parts_[kept++] = value;
    size_ = kept;
  }

  /// That of the largest part, which is larger than the rest together.
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : sign_of(parts_[size_ - 1]); }

 private:
  std::array<double, N> parts_{};
  std::size_t size_ = 0;
};

/// The 24 products of three coordinates of a determinant of four points, each in two parts.
using PlaneSum = ExactSum<48>;

/// Adds x y z. x y has 48 bits; its halves of 26 (Veltkamp 1968) times z have no more than 50.
void add_product(float x, float y, float z, PlaneSum& sum) {
  const double xy = static_cast<double>(x) * static_cast<double>(y);
  const double scaled = (0x1p27 + 1) * xy;
  const double high = scaled - (scaled - xy);
  sum.add((xy - high) * static_cast<double>(z));
  sum.add(high * static_cast<double>(z));
}

/// Adds det(p, q, r).
void add_determinant(const Vec3f& p, const Vec3f& q, const Vec3f& r, PlaneSum& sum) {
  add_product(p.x, q.y, r.z, sum);
  add_product(p.y, q.z, r.x, sum);
  add_product(p.z, q.x, r.y, sum);
  add_product(-p.x, q.z, r.y, sum);
  add_product(-p.y, q.x, r.z, sum);
  add_product(-p.z, q.y, r.x, sum);
}

Vec3f negative(const Vec3f& p) { return {-p.x, -p.y, -p.z}; }

/// det(b - a, c - a, d - a) = det(b, c, d) - det(a, c, d) + det(a, b, d) - det(a, b, c)
int exact_side_of_plane(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  PlaneSum sum;
  add_determinant(b, c, d, sum);
  add_determinant(negative(a), c, d, sum);
  add_determinant(a, b, d, sum);
  add_determinant(negative(a), b, c, sum);
  return sum.sign();
}

using Whole = __int128;

/// Four points in whole multiples of one power of two, as differences from the first; see whole_differences.
struct WholeDifferences {
  std::array<std::array<std::int64_t, 3>, 3> rows{};

  [[nodiscard]] int sign_of_determinant() const {
    const auto& [u, v, w] = rows;
    const auto minor = [&u = u, &v = v](std::size_t i, std::size_t j) {
      return Whole{u[i]} * v[j] - Whole{u[j]} * v[i];
    };
    const Whole det = w[0] * minor(1, 2) + w[1] * minor(2, 0) + w[2] * minor(0, 1);
    return (det > 0) - (det < 0);
  }
};

/// Adds the differences of one axis. @returns false if a coordinate is no whole multiple of 1 / scale
bool add_whole_axis(const std::array<double, 4>& coordinates, double scale, std::size_t axis, WholeDifferences& whole) {
  std::array<std::int64_t, 4> scaled{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = coordinates[i] * scale;  // exact: scale is a power of two
    if (!(std::abs(x) < 0x1p62)) return false;
    scaled[i] = static_cast<std::int64_t>(x);
    if (static_cast<double>(scaled[i]) != x) return false;
  }
  for (std::size_t i = 0; i < 3; ++i) whole.rows[i][axis] = scaled[i + 1] - scaled[0];
  return true;
}

/// The differences b - a, c - a, d - a, scaled so that all are below 2^41 and determinants fit into 126 bits; none if
/// the coordinates are not whole then, which is rare among points of one mesh.
/// @param largest  the largest difference of two coordinates, rounded
std::optional<WholeDifferences> whole_differences(const std::array<Vec3f, 4>& points, double largest) {
  const double scale = std::ldexp(1.0, 39 - std::ilogb(largest));  // rounding may have lost one bit
  WholeDifferences whole;
  const auto along = [&](float Vec3f::*axis) -> std::array<double, 4> {
    return {points[0].*axis, points[1].*axis, points[2].*axis, points[3].*axis};
  };
  if (!add_whole_axis(along(&Vec3f::x), scale, 0, whole) || !add_whole_axis(along(&Vec3f::y), scale, 1, whole) ||
      !add_whole_axis(along(&Vec3f::z), scale, 2, whole))
    return std::nullopt;
  return whole;
}

double largest_of(const Vec3d& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

struct Point2 {
  double x, y;
};

Point2 without(const Vec3f& p, int axis) {
  if (axis == 0) return {p.y, p.z};
  return axis == 1 ? Point2{p.z, p.x} : Point2{p.x, p.y};
}

int exact_turn(const Point2& a, const Point2& b, const Point2& c) {
  ExactSum<6> sum;
  sum.add(a.x * b.y);
  sum.add(-a.y * b.x);
  sum.add(b.x * c.y);
  sum.add(-b.y * c.x);
  sum.add(c.x * a.y);
  sum.add(-c.y * a.x);
  return sum.sign();
}

}  // namespace

int side_of_plane(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  const Vec3d u = to_double(b) - to_double(a);
  const Vec3d v = to_double(c) - to_double(a);
  const Vec3d w = to_double(d) - to_double(a);
  const double uv = u[0] * v[1], vu = v[0] * u[1];
  const double vw = v[0] * w[1], wv = w[0] * v[1];
  const double wu = w[0] * u[1], uw = u[0] * w[1];
  const double det = w[2] * (uv - vu) + u[2] * (vw - wv) + v[2] * (wu - uw);
  const double size = (std::abs(uv) + std::abs(vu)) * std::abs(w[2]) + (std::abs(vw) + std::abs(wv)) * std::abs(u[2]) +
                      (std::abs(wu) + std::abs(uw)) * std::abs(v[2]);
  const double error = kPlaneError * size;
  // A size of 0 means that every term is 0: differences of floats are 0 only where the floats are equal.
  if (det > error || det < -error || size == 0) return sign_of(det);
  if (const auto whole = whole_differences({a, b, c, d}, std::max({largest_of(u), largest_of(v), largest_of(w)})))
    return whole->sign_of_determinant();
  return exact_side_of_plane(a, b, c, d);
}

int turn(const Vec3f& a, const Vec3f& b, const Vec3f& c, int axis) {
  const Point2 p = without(a, axis), q = without(b, axis), r = without(c, axis);
  const double left = (p.x - r.x) * (q.y - r.y);
  const double right = (p.y - r.y) * (q.x - r.x);
  const double det = left - right;
  const double error = kTurnError * (std::abs(left) + std::abs(right));
  if (det > error || det < -error) return sign_of(det);
  return exact_turn(p, q, r);
}

}  // namespace pointskin::mesh_detail
