// Signed distance to a closed mesh, in double.
// Source of the sign: Baerentzen & Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE
// TVCG 2005: the pseudonormal of the feature nearest to a point tells the side that the point is on.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>

#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "mesh/closest_point.hpp"
#include "mesh/triangle_tree.hpp"

namespace pointskin::mesh_detail {

/// The place of a surface that is nearest to a point.
struct SurfacePlace {
  double distance = 0;     ///< of the point from the surface, positive inside
  Vec3d position{};        ///< on the surface
  std::int32_t slot = -1;  ///< of the triangle, a hint for points nearby
};

/// Distances to a closed, oriented, 2-manifold mesh, faces counter-clockwise from outside.
/// Memory: 88 bytes a triangle, 24 a vertex and the tree's.
class SignedDistance {
 public:
  /// @param mesh    as above, see measure(); must live as long as this
  /// @param offset  added to every vertex
  /// O(t log t). Deterministic for any number of threads.
  SignedDistance(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset);

  /// Exact up to rounding. About O(log t) for points near the surface.
  /// @param hint  slot of a triangle that may be near, or -1; changes the time taken, not the answer
  [[nodiscard]] SurfacePlace at(const Vec3d& p, std::int32_t hint = -1) const;

 private:
  void find_neighbours(exec::Cpu& ex);
  void sum_corner_normals();
  [[nodiscard]] Vec3d pseudonormal(std::int32_t triangle, const Feature& feature) const;

  const Mesh& mesh_;
  TriangleTree tree_;
  exec::Buffer<Vec3d> face_normals_;       // shape (t), unit length, or zero for triangles without a plane
  exec::Buffer<std::int32_t> neighbours_;  // shape (3 t): triangle across the edge from corner k to the next
  exec::Buffer<Vec3d> corner_normals_;     // shape (v), weighted by angles, any length
};

}  // namespace pointskin::mesh_detail
