// The mesh of blocks, as a file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/vector.hpp>

#include "exec/cpu.hpp"
#include "octree/frame.hpp"
#include "scale/block_meshes.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// The columns after the positions, in this order.
struct VertexColumns {
  struct Attribute {
    std::string name;
    AttributeType type = AttributeType::float32;
  };
  bool normals = true;
  bool density = false;
  std::vector<Attribute> attributes{};  ///< in the file before the density
};

/// Writes binary PLY, the same bytes as write_mesh() of the whole mesh: a few thousand vertices or triangles a thread are in memory.
/// Each rank writes a part of a regular file. Collective.
/// @param meshes  finished, with positions in the unit cube as the first column
/// @param frame   of the unit cube, relative to `origin`
/// @throws Error output_not_written, interrupted; invalid_input if a position or a normal is not finite. The file is then what it
///         was
void write_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns, const octree::Frame& frame,
               const Vec3d& origin, const std::string& path, const Team& team = {});

/// Writes a file for each block that has triangles: `path` with _0000, _0001, ... before its extension. Each has its own triangles, in
/// the order of the whole, and the vertices that they have: those at borders are in several files, with the same bytes. All are
/// written before the first one replaces a file of its name. Each rank writes some of them. Collective.
/// @returns the names of all
/// @throws Error as write_ply()
/// One block's triangles, and 16 bytes for each of its vertices, are in memory.
std::vector<std::string> write_split_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns,
                                         const octree::Frame& frame, const Vec3d& origin, const std::string& path,
                                         const Team& team = {});

/// The name of file `number` there.
std::string split_name(const std::string& path, std::int64_t number);

}  // namespace pointskin::scale
