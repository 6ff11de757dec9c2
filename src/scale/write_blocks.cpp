#include "scale/write_blocks.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/output.hpp"
#include "io/writers.hpp"

namespace pointskin::scale {
namespace {

static_assert(sizeof(Triangle) == sizeof(BlockMeshes::Indices));

/// Reads values of a column, for vertices first..first + count - 1 of a file.
using ReadColumn = std::function<void(std::size_t column, std::int64_t first, std::int64_t count, std::byte* out)>;

template <class T>
void read_values(const ReadColumn& read, std::size_t column, std::size_t first, std::size_t last,
                 std::vector<T>& part) {
  part.resize(last - first);
  read(column, static_cast<std::int64_t>(first), std::ssize(part), reinterpret_cast<std::byte*>(part.data()));
}

/// The vertices of a file.
io::MeshParts vertex_parts(const ReadColumn& read, const VertexColumns& columns, const octree::Frame& frame,
                           const Vec3d& origin) {
  io::MeshParts parts;
  parts.origin = origin;
  parts.positions = [=](std::size_t first, std::size_t last, std::vector<Vec3f>& part) {
    read_values(read, 0, first, last, part);
    for (Vec3f& position : part) position = frame.to_world(position);
  };
  if (columns.normals)
    parts.normals = [=](std::size_t first, std::size_t last, std::vector<Vec3f>& part) {
      read_values(read, 1, first, last, part);
    };
  const auto add = [&](const std::string& name, AttributeType type, std::size_t column) {
    parts.attributes.push_back({name, type, [=](std::size_t first, std::size_t last) {
                                  return visit_type(type, [&](auto tag) {
                                    std::vector<decltype(tag)> part;
                                    read_values(read, column, first, last, part);
                                    return AttributeValues(std::move(part));
                                  });
                                }});
  };
  const std::size_t density = columns.normals ? 2 : 1, attributes = density + (columns.density ? 1 : 0);
  for (std::size_t i = 0; i < columns.attributes.size(); ++i)
    add(columns.attributes[i].name, columns.attributes[i].type, attributes + i);
  if (columns.density) add("density", AttributeType::float32, density);
  return parts;
}

/// Of vertices by their numbers.
ReadColumn of_vertices(const BlockMeshes& meshes, const std::vector<std::int64_t>& vertices) {
  return [&](std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) {
    meshes.read_column(
        column, std::span(vertices).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)), out);
  };
}

/// Each rank a part.
void write_together(exec::Cpu& ex, const std::string& path, const io::Blocks& blocks, const Team& team) {
  std::optional<io::FileOfMany> file;
  if (team.is_first()) file.emplace(io::FileOfMany::make(path));
  const std::string name = team.of_first(file ? file->temporary_name() : std::string());
  if (!file) file.emplace(io::FileOfMany::open(path, name));
  const Team::Share own = team.share_of(blocks.count);
  file->write(ex, blocks, own.begin, own.end);
  file->finish();
  team.wait();
  if (team.is_first()) file->replace();
  team.wait();
  if (!team.is_first()) file->forget();
}

}  // namespace

void write_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns, const octree::Frame& frame,
               const Vec3d& origin, const std::string& path, const Team& team) {
  const ReadColumn read = [&](std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) {
    meshes.read_column(column, first, count, out);
  };
  io::MeshParts parts = vertex_parts(read, columns, frame, origin);
  parts.vertices = meshes.vertices();
  parts.triangles = meshes.triangles();
  parts.corners = [&](std::size_t first, std::size_t last, std::vector<Triangle>& part) {
    part.resize(last - first);
    meshes.read_triangles(static_cast<std::int64_t>(first), std::ssize(part),
                          reinterpret_cast<BlockMeshes::Indices*>(part.data()));
  };
  const io::Blocks blocks = io::format_ply_parts(parts, false);
  if (team.is_alone()) return io::write_blocks(ex, path, blocks);
  if (!team.of_first(io::is_stream(path))) return write_together(ex, path, blocks, team);
  if (team.is_first()) io::write_blocks(ex, path, blocks);
  team.wait();
}

std::string split_name(const std::string& path, std::int64_t number) {
  std::filesystem::path name(path);
  return name.replace_filename(fmt::format("{}_{:04}{}", name.stem().string(), number, name.extension().string()))
      .string();
}

std::vector<std::string> write_split_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns,
                                         const octree::Frame& frame, const Vec3d& origin, const std::string& path,
                                         const Team& team) {
  std::vector<std::string> names;
  const Team::Share own = team.share_of(meshes.blocks());
  io::FilesTogether files;
  for (std::int64_t block = 0; block < meshes.blocks(); ++block) {
    if (meshes.triangles_of(block) == 0) continue;
    names.push_back(split_name(path, std::ssize(names)));
    if (!own.has(block)) continue;
    const BlockMeshes::MeshOfBlock mesh = meshes.read_block(block);
    io::MeshParts parts = vertex_parts(of_vertices(meshes, mesh.vertices), columns, frame, origin);
    parts.vertices = std::ssize(mesh.vertices);
    parts.triangles = std::ssize(mesh.triangles);
    parts.corners = [&](std::size_t first, std::size_t last, std::vector<Triangle>& part) {
      part.assign(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first),
                  mesh.triangles.begin() + static_cast<std::ptrdiff_t>(last));
    };
    files.write(ex, names.back(), io::format_ply_parts(parts, false));
  }
  team.wait();
  files.replace();
  team.wait();
  return names;
}

}  // namespace pointskin::scale
