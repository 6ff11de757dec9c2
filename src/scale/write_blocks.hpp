// The mesh of blocks, as a file.
#pragma once

#include <string>

#include <pointskin/vector.hpp>

#include "exec/cpu.hpp"
#include "octree/frame.hpp"
#include "scale/block_meshes.hpp"

namespace pointskin::scale {

/// The columns after the positions, in this order.
struct VertexColumns {
  bool normals = true;
  bool density = false;
};

/// Writes binary PLY, the same bytes as write_mesh() of the whole mesh: a few thousand vertices or triangles a thread are in memory.
/// @param meshes  finished, with positions in the unit cube as the first column
/// @param frame   of the unit cube, relative to `origin`
/// @throws Error output_not_written, interrupted; invalid_input if a position or a normal is not finite. The file is then what it
///         was
void write_ply(exec::Cpu& ex, const BlockMeshes& meshes, const VertexColumns& columns, const octree::Frame& frame,
               const Vec3d& origin, const std::string& path);

}  // namespace pointskin::scale
