#include "rotated.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pointskin::bench {
namespace {

using Rows = std::array<Vec3d, 3>;

/// Around the unit vector (x, y, z), by an angle in radians (Rodrigues' formula).
Rows around(double x, double y, double z, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
  return {Vec3d{t * x * x + c, t * x * y - s * z, t * x * z + s * y},
          Vec3d{t * x * y + s * z, t * y * y + c, t * y * z - s * x},
          Vec3d{t * x * z - s * y, t * y * z + s * x, t * z * z + c}};
}

const Rows& rows_of(int rotation) {
  static const std::array<Rows, kRotations> all{
      around(1 / std::sqrt(14.0), 2 / std::sqrt(14.0), 3 / std::sqrt(14.0), 0.8),
      around(-2.0 / 3, 1.0 / 3, 2.0 / 3, 1.25)};
  return all[static_cast<std::size_t>(rotation - 1)];
}

class Rotated final : public Shape {
 public:
  Rotated(std::unique_ptr<Shape> shape, int rotation) : shape_(std::move(shape)), rotation_(rotation) {}

  [[nodiscard]] Sample at(const Vec3d& q) const override {
    const Sample sample = shape_->at(back(q));
    return {sample.value, rotated(sample.gradient, rotation_)};
  }
  [[nodiscard]] double variation(const Vec3d& centre, double radius) const override {
    return shape_->variation(back(centre), radius);
  }
  [[nodiscard]] double lipschitz() const override { return shape_->lipschitz(); }
  [[nodiscard]] Topology topology() const override { return shape_->topology(); }
  [[nodiscard]] bool is_distance() const override { return shape_->is_distance(); }
  [[nodiscard]] SurfacePoint closest(const Vec3d& q) const override { return forth(shape_->closest(back(q))); }
  [[nodiscard]] bool is_seen(const Vec3d& q) const override { return shape_->is_seen(back(q)); }
  [[nodiscard]] double own_area() const override { return shape_->own_area(); }
  [[nodiscard]] SurfacePoint draw(Random& random) const override { return forth(shape_->draw(random)); }

 private:
  [[nodiscard]] Vec3d back(const Vec3d& q) const { return unrotated(q, rotation_); }
  [[nodiscard]] SurfacePoint forth(const SurfacePoint& p) const {
    return {rotated(p.position, rotation_), rotated(p.normal, rotation_)};
  }

  std::unique_ptr<Shape> shape_;
  int rotation_;
};

}  // namespace

Vec3d rotated(const Vec3d& v, int rotation) {
  const Rows& rows = rows_of(rotation);
  return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
}

Vec3d unrotated(const Vec3d& v, int rotation) {
  const Rows& rows = rows_of(rotation);
  return rows[0] * v.x + rows[1] * v.y + rows[2] * v.z;
}

void rotate(Mesh& mesh, int rotation) {
  if (rotation < 1 || rotation > kRotations) throw Error(ErrorCode::usage, "there are the rotations 1 and 2");
  const auto turn = [rotation](Vec3f& v) {
    const Vec3d to = rotated({v.x, v.y, v.z}, rotation);
    v = {static_cast<float>(to.x), static_cast<float>(to.y), static_cast<float>(to.z)};
  };
  std::for_each(mesh.vertices.begin(), mesh.vertices.end(), turn);
  std::for_each(mesh.normals.begin(), mesh.normals.end(), turn);
  mesh.origin = rotated(mesh.origin, rotation);
}

std::unique_ptr<Shape> make_rotated(std::unique_ptr<Shape> shape, int rotation) {
  return std::make_unique<Rotated>(std::move(shape), rotation);
}

}  // namespace pointskin::bench
