// What meshes and clouds have in common for a picture.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include <string>
#include <vector>

namespace pointskin::render_detail {

/// Positions with their normals and attributes, of a mesh or a cloud that must outlive it.
struct Vertices {
  const char* owner;  ///< "mesh" or "cloud", for stories
  const Vec3d& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Attribute>& attributes;

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool has_normals() const { return !positions.empty() && normals.size() == positions.size(); }

  /// The attribute `name` with a value for every position, or null.
  [[nodiscard]] const Attribute* find(const std::string& name) const {
    for (const Attribute& attribute : attributes)
      if (attribute.name == name && attribute.values.size() == positions.size()) return &attribute;
    return nullptr;
  }
};

inline Vertices vertices_of(const Mesh& mesh) {
  return {"mesh", mesh.origin, mesh.vertices, mesh.normals, mesh.attributes};
}
inline Vertices vertices_of(const Cloud& cloud) {
  return {"cloud", cloud.origin, cloud.positions, cloud.normals, cloud.attributes};
}

}  // namespace pointskin::render_detail
