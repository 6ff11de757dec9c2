// The implicit function on its octree.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>

namespace pointskin {

namespace detail {
class FieldImpl;
}

/// The function u of docs/algorithm.md: about 1 inside, 0 outside, continuous, trilinear in every leaf; with
/// FieldKind::distance or Options::offset minus a signed distance, in finest cells, positive inside. The surface is
/// where u equals isovalue(). A cheap handle; copies share the same data. Fields use their Reconstructor's stream and
/// memory pool: a Reconstructor and its fields belong to one thread at a time.
class Field {
 public:
  explicit Field(std::shared_ptr<detail::FieldImpl> impl);

  /// Weighted mean of u over the samples; 0 for FieldKind::distance, minus the offset in finest cells with
  /// Options::offset.
  [[nodiscard]] double isovalue() const;

  /// Side of the working cube in world units, and its lower corner in world coordinates.
  [[nodiscard]] double cube_size_world() const;
  [[nodiscard]] Vec3d cube_lower_world() const;

  /// u at `points_world`; points outside of the cube get the value at the nearest point of the cube.
  /// O(n depth). Deterministic.
  [[nodiscard]] std::vector<float> values(const std::vector<Vec3d>& points_world) const;

  /// The level set u = isovalue() as a 2-manifold, outward-oriented mesh with vertices in Morton order, closed
  /// unless Options::domain_faces is open or Options::trim cuts it: new vertices at the cut then come last.
  /// @throws Error empty_result if nothing crosses the isovalue, or nothing is left after Options::trim
  [[nodiscard]] Mesh extract() const;

 private:
  std::shared_ptr<detail::FieldImpl> impl_;
};

}  // namespace pointskin
