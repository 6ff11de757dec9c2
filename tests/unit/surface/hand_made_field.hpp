// Fields whose corner values the test chooses, and their surfaces as meshes.
#pragma once

#include <pointskin/mesh.hpp>

#include <functional>
#include <vector>

#include "field/field_view.hpp"
#include "surface/edge_vertex.hpp"
#include "surface/extract.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin::test {

/// Value of a corner of a level, asked only for corners that are unknowns.
using CornerValue = std::function<float(const octree::LevelView& level, const octree::Coordinates& corner)>;

/// Level-major corner values: `value` at unknowns, the interpolation of the level above elsewhere, which makes the
/// field continuous, as the solver does (poisson/solve.hpp).
inline std::vector<float> continuous_values(const octree::OctreeView& tree, const CornerValue& value) {
  std::vector<float> values(static_cast<std::size_t>(tree.nodes));
  for (int d = 0; d <= tree.depth; ++d) {
    const octree::LevelView& level = tree.levels[d];
    float* u = values.data() + level.first_node;
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      if (is_unknown(level, n))
        u[n] = value(level, corner_at(level, n));
      else if (d > 0)
        u[n] = octree::prolonged(tree.levels[d - 1], values.data() + tree.levels[d - 1].first_node,
                                 level.parent[n >> 3], static_cast<int>(n & 7));
    }
  }
  return values;
}

/// A function of the position in the unit cube.
inline CornerValue at_positions(const std::function<double(const Vec3d&)>& f) {
  return [f](const octree::LevelView& level, const octree::Coordinates& c) {
    const double h = 1.0 / static_cast<double>(1 << level.depth);
    return static_cast<float>(f({c.x * h, c.y * h, c.z * h}));
  };
}

/// The level set as a mesh of the unit cube.
inline Mesh extracted(SmallTree& tree, const std::vector<float>& values, float isovalue, bool closed,
                      const surface::ExtractOptions& options = {}) {
  const surface::Surface s =
      surface::extract_surface(tree.ex, field::FieldView{tree.view, values.data(), isovalue, closed}, options);
  Mesh mesh;
  mesh.vertices.assign(s.positions.data(), s.positions.data() + s.positions.size());
  mesh.normals.assign(s.normals.data(), s.normals.data() + s.normals.size());
  mesh.triangles.assign(s.triangles.data(), s.triangles.data() + s.triangles.size());
  return mesh;
}

}  // namespace pointskin::test
