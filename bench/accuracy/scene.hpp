// What a virtual scanner looks at: a mesh or a shape.
#pragma once

#include <memory>

#include "ray_tree.hpp"
#include "shapes.hpp"

namespace pointskin::bench {

/// A surface that rays can meet, and its bounding box.
class Scene {
 public:
  virtual ~Scene() = default;
  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// The first point of the surface along `ray`, or nothing.
  [[nodiscard]] virtual std::optional<Hit> first_hit(const Ray& ray) const = 0;

  Vec3d lower{}, upper{};  ///< the box, world units

  [[nodiscard]] Vec3d centre() const;
  [[nodiscard]] double diagonal() const;
};

/// The triangles of `mesh`.
/// @throws Error invalid_input if it has no triangle
std::unique_ptr<Scene> scene_of(const Mesh& mesh);

/// The surface of `shape`, which must outlive the scene. Rays that start inside of the solid are not meant. A ray that
/// runs along the surface, nearer than 1e-6 over thousands of steps, hits it.
std::unique_ptr<Scene> scene_of(const Shape& shape);

}  // namespace pointskin::bench
