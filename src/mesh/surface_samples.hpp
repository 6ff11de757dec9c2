// Area-uniform points on a mesh.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {

struct SurfaceSample {
  Vec3d point;
  Vec3d normal;  ///< of the triangle, unit length; zero if the triangle has no area
};

/// Draws points of a mesh, as many per area everywhere. The mesh must outlive the sampler.
/// Sample i of n falls into the i-th of n strata of equal area, laid end to end in the order of the triangles.
class SurfaceSampler {
 public:
  /// @param mesh    at least one triangle, ids in range, corners finite; without any area its triangles count alike
  /// @param offset  added to every vertex
  /// O(t). Deterministic for any number of threads.
  SurfaceSampler(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset);

  /// Sample `i` of `n`. O(log t). A function of its arguments alone.
  [[nodiscard]] SurfaceSample sample(std::int64_t i, std::int64_t n) const;

 private:
  const Mesh& mesh_;
  Vec3d offset_;
  exec::Buffer<double> area_before_;  // shape (t + 1), the last is the whole
};

}  // namespace pointskin::mesh_detail
