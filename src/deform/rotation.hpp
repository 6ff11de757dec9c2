// Rotations by an angle that every point has for itself, with the same bits on every device.
// Source: Rodrigues' formula; range reduction after Cody & Waite, "Software manual for the elementary functions", 1980.
// Differs: Taylor sums, which are exact to the last bits on the intervals used, instead of libm, whose bits differ.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/vec3.hpp"

namespace pointskin::deform {

/// sin and cos of an angle in [0, 1000]; absolute error at most 4e-16.
struct SineCosine {
  double sine = 0, cosine = 1;
};
PSK_HD inline SineCosine sine_cosine(double angle) {
  constexpr double kQuarter = 0x1.921fb544p+0;            // pi/2, its upper 33 bits: products with quarters are exact
  constexpr double kQuarterRest = 0x1.0b4611a626331p-34;  // and the next 53
  const auto quarters = static_cast<std::int64_t>(angle * 0.6366197723675814 + 0.5);
  const auto q = static_cast<double>(quarters);
  const double r = (angle - q * kQuarter) - q * kQuarterRest;
  const double s = r * r;
  double sine = 0;
  double cosine = 0;
  for (int k = 8; k >= 1; --k) {  // Horner: 1 - s/(2.3) (1 - s/(4.5) (...
    sine = (1 - sine) * s / static_cast<double>(2 * k * (2 * k + 1));
    cosine = (1 - cosine) * s / static_cast<double>((2 * k - 1) * 2 * k);
  }
  sine = r * (1 - sine);
  cosine = 1 - cosine;
  switch (quarters & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// Functions of an angle f, given f^2, in which nothing cancels: sin f / f, (1 - cos f) / f^2, (f - sin f) / f^3.
struct RotationTerms {
  double one = 1, two = 0.5, three = 1.0 / 6;
};
PSK_HD inline RotationTerms rotation_terms(double squared) {
  if (squared < 1) {
    double one = 0;
    double two = 0;
    double three = 0;
    for (int k = 9; k >= 1; --k) {
      one = (1 - one) * squared / static_cast<double>(2 * k * (2 * k + 1));
      two = (1 - two) * squared / static_cast<double>((2 * k + 1) * (2 * k + 2));
      three = (1 - three) * squared / static_cast<double>((2 * k + 2) * (2 * k + 3));
    }
    return {1 - one, (1 - two) / 2, (1 - three) / 6};
  }
  const double angle = std::sqrt(squared);
  const SineCosine at = sine_cosine(angle);
  const double one = at.sine / angle;
  return {one, (1 - at.cosine) / squared, (1 - one) / squared};
}

/// exp([w]x) for a rotation vector w: axis times angle.
struct Rotation {
  Vec3d vector;
  RotationTerms terms;

  PSK_HD explicit Rotation(const Vec3d& w) : vector(w), terms(rotation_terms(dot(w, w))) {}

  /// R v - v, without cancellation; exactly 0 for w = 0.
  PSK_HD Vec3d moved_by(const Vec3d& v) const {
    const Vec3d once = cross(vector, v);
    return once * terms.one + cross(vector, once) * terms.two;
  }
  PSK_HD Vec3d operator*(const Vec3d& v) const { return v + moved_by(v); }

  /// Derivative of R v when w changes by `change`, given R v: (J change) x R v with the left Jacobian J of SO(3).
  PSK_HD Vec3d derivative(const Vec3d& change, const Vec3d& rotated) const {
    const Vec3d spin =
        change * terms.one + vector * (terms.three * dot(vector, change)) + cross(vector, change) * terms.two;
    return cross(spin, rotated);
  }
};

}  // namespace pointskin::deform
