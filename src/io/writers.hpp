// Meshes and clouds as bytes. Blocks are formatted in parallel; the bytes do not depend on the number of threads.
#pragma once

#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"

namespace pointskin::io {

/// What PLY stores per vertex, of a cloud or of a mesh.
struct VertexArrays {
  const Vec3d& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Attribute>& attributes;
};

/// Binary little endian PLY in one part. `triangles` null: no face element. Coordinates are double, and in world
/// units, if the origin is not zero.
/// @throws Error usage if an array has the wrong length or a name comes twice
std::vector<std::string> format_ply(exec::Cpu& ex, const VertexArrays& vertices,
                                    const std::vector<Triangle>* triangles);

/// OBJ text in parts: world coordinates in the fewest digits that read back equal.
std::vector<std::string> format_obj(exec::Cpu& ex, const Mesh& mesh);

/// Binary STL in one part, world coordinates as float.
/// @throws Error over_limit for more than 2^32 - 1 triangles
std::vector<std::string> format_stl(exec::Cpu& ex, const Mesh& mesh);

/// `origin` + `p`.
inline Vec3d world(const Vec3d& origin, const Vec3f& p) {
  return {origin[0] + static_cast<double>(p.x), origin[1] + static_cast<double>(p.y),
          origin[2] + static_cast<double>(p.z)};
}

inline bool is_zero(const Vec3d& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

}  // namespace pointskin::io
