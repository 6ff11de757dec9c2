// Files that are larger than memory.
#pragma once

#include <cstdint>
#include <string>

#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin PSK_EXPORT {

struct ScaleOptions {
  std::int64_t max_memory_bytes = 0;  ///< that the work may take, beside the program; 0: as much as it likes
  int threads = 0;  ///< CPU threads, 0: all; fewer where their buffers would take too much of the memory
};

/// Counts and measures the mesh in a file: the same numbers, to the last bit, as measure(read_mesh(path)).
///
/// Where that needs more memory than it may take, the file is read in parts, again and again, and never held: memory then
/// has 4 bytes and a bit for each vertex, and what lies around as many vertices at once as there is room for. That takes
/// a binary PLY file whose vertices have no lists and whose faces are triangles, as write_mesh() makes it. Others are read
/// as a whole if six times their size is within the limit, and the mesh with what measuring takes proves to be.
/// O(t log t) time, and two readings of the triangles for each range of vertices. Deterministic for any options.
/// @throws Error invalid_input as read_mesh() and measure(), and if the file changes meanwhile; over_limit if the limit is
///         too small, which says how much would do, or if a file above it cannot be read in parts
MeshReport measure_file(const std::string& path, const ScaleOptions& options = {});

}  // namespace pointskin PSK_EXPORT
