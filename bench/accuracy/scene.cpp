// Source: Hart, "Sphere tracing", The Visual Computer 12, 1996.
#include "scene.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

class MeshScene final : public Scene {
 public:
  explicit MeshScene(const Mesh& mesh) : tree_(mesh) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    lower = {kInfinity, kInfinity, kInfinity};
    upper = -lower;
    for (const Triangle& t : mesh.triangles) {
      for (const std::int32_t vertex : t) {
        const Vec3d p = mesh.origin + to_double(mesh.vertices[static_cast<std::size_t>(vertex)]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          lower[axis] = std::min(lower[axis], p[axis]);
          upper[axis] = std::max(upper[axis], p[axis]);
        }
      }
    }
  }

  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray) const override { return tree_.first_hit(ray); }

 private:
  RayTree tree_;
};

class ShapeScene final : public Scene {
 public:
  explicit ShapeScene(const Shape& shape) : shape_(shape) {
    const Bounds box = bounds_of(sample_surface(shape, {.points = 100'000, .seed = 1}).positions);
    lower = to_double(box.lower);
    upper = to_double(box.upper);
  }

  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray) const override {
    // Nothing lies outside of the ball around the origin that holds every shape's cube.
    const double radius2 = 3 * kHalfExtent * kHalfExtent;
    const double middle = -dot(ray.origin, ray.direction);
    const double half2 = radius2 - dot(ray.origin, ray.origin) + middle * middle;
    if (half2 <= 0) return std::nullopt;
    double range = std::max(0.0, middle - std::sqrt(half2));
    const double end = middle + std::sqrt(half2);
    Sample sample;
    for (int step = 0; step < kSteps && range < end; ++step) {
      sample = shape_.at(ray.origin + range * ray.direction);
      const double safe = sample.value / shape_.lipschitz();
      if (safe < kTouch) return Hit{range, normalized(sample.gradient)};
      range += safe;
    }
    if (range >= end || sample.value > kGrazing) return std::nullopt;
    return Hit{range, normalized(sample.gradient)};
  }

 private:
  static constexpr int kSteps = 4000;
  static constexpr double kTouch = 1e-9, kGrazing = 1e-6;

  const Shape& shape_;
};

}  // namespace

Vec3d Scene::centre() const { return 0.5 * (lower + upper); }
double Scene::diagonal() const { return length(upper - lower); }

std::unique_ptr<Scene> scene_of(const Mesh& mesh) {
  measure(mesh);  // checks the indices
  if (mesh.triangles.empty()) throw Error(ErrorCode::invalid_input, "the mesh has no triangle");
  return std::make_unique<MeshScene>(mesh);
}

std::unique_ptr<Scene> scene_of(const Shape& shape) { return std::make_unique<ShapeScene>(shape); }

}  // namespace pointskin::bench
