// The nearest point of a shape's surface, exact up to rounding.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <optional>

#include "exec/cpu_primitives.hpp"
#include "mesh/triangle_tree.hpp"
#include "shapes.hpp"

namespace pointskin::bench {

/// Finds nearest points. Shapes that are distance functions know them by a formula. For the others the nearest of many
/// samples of the surface, or the projection of q if that is nearer, is the start of Newton's method for the point
/// where the line to q is normal to the surface. The shape must outlive it.
class ClosestPoint {
 public:
  /// O(seeds log seeds), for shapes that are no distance functions. Deterministic for any number of threads.
  /// @param seeds  samples to start from, > 0
  ClosestPoint(exec::Cpu& ex, const Shape& shape, std::int64_t seeds = 400'000);

  /// The point of the surface nearest to `q` and the outward normal there. The distance is good to about 1e-9 and never
  /// too small. Only where two places are about equally near may the other one be found; the distance is then too large
  /// by less than the square of the seeds' spacing times the curvature, 1e-4 with 400,000 seeds.
  [[nodiscard]] SurfacePoint operator()(const Vec3d& q) const;

 private:
  const Shape& shape_;
  Mesh seeds_;  // triangles without extent, one a sample
  std::optional<mesh_detail::TriangleTree> tree_;
};

}  // namespace pointskin::bench
