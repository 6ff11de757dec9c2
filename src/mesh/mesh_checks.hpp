// What the mesh tools ask of a mesh before they touch it.
#pragma once

#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"

namespace pointskin::mesh_detail {

/// @throws Error invalid_input, naming the first triangle that names a vertex outside of [0, v); over_limit if there
///         are more triangles than 32-bit ids
/// O(t). Deterministic: always the first such triangle.
void check_indices(exec::Cpu& ex, const Mesh& mesh);

/// Box around the corners of triangles, relative to Mesh::origin.
struct CornerBounds {
  Vec3d lower{0, 0, 0}, upper{0, 0, 0};
  bool finite = true;  ///< every corner of every triangle is finite

  /// The box around nothing, to add to.
  static CornerBounds none();
  void add(const Vec3f& vertex);
  void add(const CornerBounds& other);
  /// All zero if nothing finite was added.
  void close();

  [[nodiscard]] Vec3d centre() const;
  [[nodiscard]] double diagonal() const;
};

/// The box of the vertices that some triangle uses; all zero if there is no triangle. Ids must be in range.
/// Non-finite coordinates do not count. O(t), exact.
CornerBounds corner_bounds(exec::Cpu& ex, const Mesh& mesh);

}  // namespace pointskin::mesh_detail
