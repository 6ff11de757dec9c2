// The implicit functions. The gyroid shell is the accuracy benchmark of this project; the others probe topology:
// genus 1 (torus), thin tubes passing close by (knot), two sheets a few cells apart (plate), sharp edges (slab),
// surfaces inside of surfaces (nested), a handle to be parted by hand (hand.cpp).
// Rounded boxes and tubes as distance functions: J. C. Hart, "Sphere tracing", The Visual Computer 12, 1996.
#include "shapes.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hand.hpp"
#include "random.hpp"
#include "rotated.hpp"
#include "smooth.hpp"

namespace pointskin::bench {
namespace {

class Gyroid final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, -178}; }  // genus 90; shapes_test counts it
  [[nodiscard]] bool is_distance() const override { return false; }
  // |grad ((g^2 - 0.16) / 9)| = 2 |g| |grad g / 9|, with |g| <= 1.5 and three components of at most 1.
  [[nodiscard]] double lipschitz() const override { return 3 * std::sqrt(3.0); }

  [[nodiscard]] Sample at(const Vec3d& q) const override {
    return smooth_max(shell(q), {length(q) - 1, direction(q)}, 0.02);
  }

  [[nodiscard]] double variation(const Vec3d& centre, double radius) const override {
    // smooth_max changes by no more than the larger change of its arguments. The ball's is the radius. The shell's
    // second derivative is at most 2/9 (|grad g|^2 + |g| |D^2 g|) <= 2/9 (6 * 81 + 1.3 * 162) < 160, because
    // |g| <= 0.4 on the surface, so |g| <= 0.4 + 22 * 0.04 < 1.3 here.
    if (radius > 0.04) return std::numeric_limits<double>::infinity();
    return std::max(radius, length(shell(centre).gradient) * radius + 80 * radius * radius);
  }

 private:
  static Sample shell(const Vec3d& q) {
    const Vec3d s = {std::sin(9 * q[0]), std::sin(9 * q[1]), std::sin(9 * q[2])};
    const Vec3d c = {std::cos(9 * q[0]), std::cos(9 * q[1]), std::cos(9 * q[2])};
    const double g = s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
    // grad ((g^2 - 0.16) / 9) = 2 g grad g / 9; the 9 of grad g cancels.
    const Vec3d gradient = {c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1], c[2] * c[0] - s[1] * s[2]};
    return {(g * g - 0.16) / 9, gradient * (2 * g)};
  }
};

class Sphere final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, 2}; }
  [[nodiscard]] Sample at(const Vec3d& q) const override { return {length(q) - 1, direction(q)}; }
  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }
};

class Torus final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, 0}; }
  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const double from_axis = std::hypot(q[0], q[1]);
    const Vec3d out = from_axis > 0 ? Vec3d{q[0] / from_axis, q[1] / from_axis, 0} : Vec3d{1, 0, 0};
    const Vec3d from_core = q - out * 0.7;
    return {length(from_core) - 0.25, direction(from_core)};
  }
  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }
};

/// Distance to a (2, 3) torus knot less a radius, less bumps that are a smooth function of space.
class Knot final : public Shape {
 public:
  Knot() {
    for (int i = 0; i < kPieces; ++i) nodes_[static_cast<std::size_t>(i)] = curve(i * kStep);
  }

  [[nodiscard]] Topology topology() const override { return {1, 0}; }
  [[nodiscard]] bool is_distance() const override { return false; }
  [[nodiscard]] double lipschitz() const override { return 1 + kBump * kWaves; }

  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const Vec3d from_curve = q - curve(nearest(q));
    const Vec3d s = {std::sin(kWaves * q[0]), std::sin(kWaves * q[1]), std::sin(kWaves * q[2])};
    const Vec3d c = {std::cos(kWaves * q[0]), std::cos(kWaves * q[1]), std::cos(kWaves * q[2])};
    const Vec3d bump = {c[0] * s[1] * s[2], s[0] * c[1] * s[2], s[0] * s[1] * c[2]};
    return {length(from_curve) - kRadius - kBump * s[0] * s[1] * s[2],
            direction(from_curve) + bump * (-kBump * kWaves)};
  }

  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override {
    return (1 + kBump * kWaves) * radius;  // the product of three sines changes by at most kWaves a unit
  }

 private:
  static constexpr int kPieces = 192;
  static constexpr double kStep = 2 * std::numbers::pi / kPieces;
  static constexpr double kRadius = 0.11, kBump = 0.015, kWaves = 25;

  static Vec3d curve(double t) {
    const double reach = 0.62 + 0.25 * std::cos(3 * t);
    return {reach * std::cos(2 * t), reach * std::sin(2 * t), 0.25 * std::sin(3 * t)};
  }

  /// The parameter of the nearest point of the curve: best of the nodes, then Newton steps on the squared distance.
  [[nodiscard]] double nearest(const Vec3d& q) const {
    std::array<double, kPieces> squared;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Vec3d d = nodes_[i] - q;
      squared[i] = dot(d, d);
    }
    double t = static_cast<double>(std::min_element(squared.begin(), squared.end()) - squared.begin()) * kStep;
    for (int step = 0; step < 6; ++step) {
      const double reach = 0.62 + 0.25 * std::cos(3 * t), slope = -0.75 * std::sin(3 * t);
      const double c = std::cos(2 * t), s = std::sin(2 * t);
      const Vec3d first = {slope * c - 2 * reach * s, slope * s + 2 * reach * c, 0.75 * std::cos(3 * t)};
      const double bend = -2.25 * std::cos(3 * t);
      const Vec3d second = {(bend - 4 * reach) * c - 4 * slope * s, (bend - 4 * reach) * s + 4 * slope * c,
                            -2.25 * std::sin(3 * t)};
      const Vec3d off = curve(t) - q;
      const double curvature = dot(first, first) + dot(off, second);
      if (curvature <= 0) break;  // far from the curve: no minimum to refine
      const double move = std::clamp(dot(off, first) / curvature, -kStep, kStep);
      t -= move;
      if (std::abs(move) < 1e-13) break;
    }
    return t;
  }

  std::array<Vec3d, kPieces> nodes_{};
};

/// A rectangle thickened by balls.
class Plate final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, 2}; }
  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const Vec3d off = {q[0] - std::clamp(q[0], -0.88, 0.88), q[1] - std::clamp(q[1], -0.58, 0.58), q[2]};
    return {length(off) - 0.02, direction(off)};
  }
  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }
};

/// A box. Its samples are drawn face by face: a band around it would crowd them on the edges.
class Slab final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, 2}; }

  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const Vec3d off = beyond(q);
    const std::size_t face = most_beyond(off);
    if (off[face] <= 0) return {off[face], face_normal(q, face)};
    Vec3d outside;
    for (std::size_t axis = 0; axis < 3; ++axis) outside[axis] = std::copysign(std::max(off[axis], 0.0), q[axis]);
    return {length(outside), direction(outside)};
  }

  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }

  /// Beyond an edge the normal is that of the face whose plane is farther away.
  [[nodiscard]] SurfacePoint closest(const Vec3d& q) const override {
    const std::size_t face = most_beyond(beyond(q));
    Vec3d position = q;
    for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = std::clamp(q[axis], -kHalf[axis], kHalf[axis]);
    position[face] = std::copysign(kHalf[face], q[face]);
    return {position, face_normal(q, face)};
  }

  [[nodiscard]] double own_area() const override { return 2 * (pair_area(0) + pair_area(1) + pair_area(2)); }

  [[nodiscard]] SurfacePoint draw(Random& random) const override {
    const double place = random.uniform() * own_area() / 2;
    const std::size_t face = place < pair_area(0) ? 0 : place < pair_area(0) + pair_area(1) ? 1 : 2;
    Vec3d q;
    for (std::size_t axis = 0; axis < 3; ++axis) q[axis] = kHalf[axis] * (2 * random.uniform() - 1);
    q[face] = std::copysign(kHalf[face], random.uniform() - 0.5);
    return {q, face_normal(q, face)};
  }

 private:
  static constexpr Vec3d kHalf = {0.9, 0.6, 0.02};

  /// Area of one of the two faces across `axis`.
  static double pair_area(std::size_t axis) { return 4 * kHalf[(axis + 1) % 3] * kHalf[(axis + 2) % 3]; }
  static Vec3d beyond(const Vec3d& q) {
    return {std::abs(q[0]) - kHalf[0], std::abs(q[1]) - kHalf[1], std::abs(q[2]) - kHalf[2]};
  }
  static std::size_t most_beyond(const Vec3d& off) {
    const std::size_t most = off.x < off.y ? 1 : 0;
    return off[most] < off.z ? 2 : most;
  }
  static Vec3d face_normal(const Vec3d& q, std::size_t face) {
    Vec3d normal{0, 0, 0};
    normal[face] = std::copysign(1.0, q[face]);
    return normal;
  }
};

/// Concentric spheres; the middle one is the wall of a cavity.
class Nested final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {3, 6}; }

  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const double r = length(q);
    const double ball = r - 0.3, cavity = 0.6 - r, rim = r - 0.95;
    if (ball <= std::max(cavity, rim)) return {ball, direction(q)};
    return cavity >= rim ? Sample{cavity, -direction(q)} : Sample{rim, direction(q)};
  }

  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }
};

}  // namespace

SurfacePoint Shape::closest(const Vec3d& q) const {
  const Sample sample = at(q);
  return {q - sample.gradient * sample.value, sample.gradient};
}

SurfacePoint Shape::draw(Random& /*random*/) const {
  throw Error(ErrorCode::internal, "this shape does not draw its own samples");
}

std::unique_ptr<Shape> make_shape(const std::string& name) {
  if (const std::size_t sign = name.find('@'); sign != std::string::npos) {
    const std::string rotation = name.substr(sign + 1);
    if (rotation != "1" && rotation != "2")
      throw Error(ErrorCode::usage, "'" + name + "': there are the rotations @1 and @2");
    return make_rotated(make_shape(name.substr(0, sign)), rotation[0] - '0');
  }
  if (name == "gyroid") return std::make_unique<Gyroid>();
  if (name == "sphere") return std::make_unique<Sphere>();
  if (name == "torus") return std::make_unique<Torus>();
  if (name == "knot") return std::make_unique<Knot>();
  if (name == "plate") return std::make_unique<Plate>();
  if (name == "slab") return std::make_unique<Slab>();
  if (name == "nested") return std::make_unique<Nested>();
  if (name == "hand") return make_hand();
  throw Error(ErrorCode::usage,
              "no shape is called '" + name + "'; there are gyroid, sphere, torus, knot, plate, slab, nested and hand");
}

double signed_distance(const Shape& shape, const Vec3d& q) {
  const Sample sample = shape.at(q);
  return sample.value / length(sample.gradient);
}

SurfacePoint project(const Shape& shape, Vec3d q, Sample sample) {
  double norm2 = 0;
  for (int step = 0; step < 30; ++step) {
    norm2 = dot(sample.gradient, sample.gradient);
    if (sample.value * sample.value < 1e-26 * norm2) break;
    for (std::size_t axis = 0; axis < 3; ++axis) q[axis] -= sample.value / norm2 * sample.gradient[axis];
    sample = shape.at(q);
  }
  const double norm = std::sqrt(norm2);
  return {q, {sample.gradient[0] / norm, sample.gradient[1] / norm, sample.gradient[2] / norm}};
}

}  // namespace pointskin::bench
