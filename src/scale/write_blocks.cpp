#include "scale/write_blocks.hpp"

#include <cstddef>
#include <vector>

#include "io/output.hpp"
#include "io/writers.hpp"

namespace pointskin::scale {
namespace {

static_assert(sizeof(Triangle) == sizeof(BlockMeshes::Indices));

template <class T>
void read_values(const BlockMeshes& meshes, std::size_t column, std::size_t first, std::size_t last,
                 std::vector<T>& part) {
  part.resize(last - first);
  meshes.read_column(column, static_cast<std::int64_t>(first), std::ssize(part),
                     reinterpret_cast<std::byte*>(part.data()));
}

}  // namespace

void write_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns, const octree::Frame& frame,
               const Vec3d& origin, const std::string& path) {
  io::MeshParts parts{origin, meshes.vertices(), meshes.triangles()};
  parts.positions = [&](std::size_t first, std::size_t last, std::vector<Vec3f>& part) {
    read_values(meshes, 0, first, last, part);
    for (Vec3f& position : part) position = frame.to_world(position);
  };
  if (columns.normals)
    parts.normals = [&](std::size_t first, std::size_t last, std::vector<Vec3f>& part) {
      read_values(meshes, 1, first, last, part);
    };
  if (columns.density)
    parts.attributes.push_back(
        {"density", AttributeType::float32, [&](std::size_t first, std::size_t last) -> AttributeValues {
           std::vector<float> part;
           read_values(meshes, columns.normals ? 2 : 1, first, last, part);
           return part;
         }});
  parts.corners = [&](std::size_t first, std::size_t last, std::vector<Triangle>& part) {
    part.resize(last - first);
    meshes.read_triangles(static_cast<std::int64_t>(first), std::ssize(part),
                          reinterpret_cast<BlockMeshes::Indices*>(part.data()));
  };
  io::write_blocks(ex, path, io::format_ply_parts(parts, false));
}

}  // namespace pointskin::scale
