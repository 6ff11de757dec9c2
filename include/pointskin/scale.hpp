// Files that are larger than memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/ranks.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/vector.hpp>

namespace pointskin PSK_EXPORT {

struct ScaleOptions {
  /// That the work may take, beside the program; with a GPU, of its memory. 0: as much as it likes, or as the GPU has.
  std::int64_t max_memory_bytes = 0;
  int threads = 0;  ///< CPU threads, 0: all; fewer where their buffers would take too much of the memory
  /// What positions are relative to, as ReadOptions::shift has it; for reconstruct_files().
  std::optional<Vec3d> shift{};
  std::string temp_folder{};  ///< for temporary data, on a disk; empty: that of the system (TMPDIR, or /tmp)
  bool split = false;         ///< reconstruct_files() writes a file for each block instead of one
  bool only_colours = false;  ///< with Options::attributes reconstruct_files() keeps red, green and blue alone
  Device device{};  ///< that works on the blocks, for reconstruct_files(); its own number of threads does not count
  /// Processes that share the work of reconstruct_files(), which all of them call with the same arguments, but for their devices:
  /// null for one alone. The input, the output and temp_folder lie where all reach them; max_memory_bytes is for each.
  Ranks* ranks = nullptr;
};

/// What reconstruct_files() did.
struct FilesReport {
  RunReport run;                    ///< without residuals
  std::int64_t dropped = 0;         ///< rows of the file whose coordinates are not finite
  std::int64_t without_normal = 0;  ///< points that were left out because their normal is zero
  std::int64_t vertices = 0, triangles = 0;
  int blocks = 0;                       ///< that the cloud was worked on in, one after another
  int coarse_level = 0;                 ///< levels of the octree up to this one were there as a whole
  std::vector<std::string> attributes;  ///< of the points that the mesh has, by their names on the mesh
  std::vector<std::string>
      outputs;  ///< that were written; with ranks the first one's report names those of ScaleOptions::split
};

/// Whether the points of a file can be read in parts: text (of columns, or PLY), or a binary PLY or NPY file whose rows are of one
/// length; "-" for stdin if that is such a file.
/// @throws Error invalid_input if it cannot be opened, or its header is garbled
bool reads_in_parts(const std::string& path);

/// What of such a run cannot be worked on in blocks yet, in words: "weakness", "an envelope". Empty if all can. With attributes that
/// depends on the files: integers that some of several files lack cannot; of files that can be read in parts the header is looked at,
/// and all of text.
/// @throws Error invalid_input if a file cannot be opened, or its header is garbled
std::vector<std::string> missing_in_blocks(const std::vector<std::string>& inputs, const Options& options,
                                           const ScaleOptions& scale = {});

/// Reconstructs a cloud that memory does not hold: from a file to a file, with the same bytes that reconstructing the whole in
/// memory and writing it would give, for any memory, any number of threads and any device.
///
/// Reads the file in parts, twice or three times, sorts its points on the disk, and works on blocks of the octree one after another,
/// each with a ring of cells around it; the coarse levels are there as a whole. Points whose normal is zero are left out, as `pointskin
/// reconstruct` does. Normals that point inwards are turned; others that seem wrong are kept, with a warning, as where a limit
/// leaves no memory for repairing them.
/// Memory: a third for the coarse levels, the rest for one block with its ring; with a GPU the limit is for its memory, and the host
/// has the coarse levels, and the samples and the mesh of one block on their way. Disk: 80 bytes a point while they are sorted, then
/// 60, and 4 a node of the octree, and the mesh; with attributes twice and then once their own, with Options::trim 4 more a point,
/// and the mesh twice. Time: some two and a half
/// times that of the whole in memory.
/// @param inputs   1 to 200 files of oriented points, for which reads_in_parts() is true, merged in their order as merge_into() does;
///                 text is parsed anew in every pass
/// @param output   a PLY file, written whole or not at all; with ScaleOptions::split one for each block that has triangles, named by
///                 it and a number from 0 on before the extension, such as mesh_0003.ply: each has its own triangles, and the
///                 vertices that they have, those at borders with the same bytes in several; all appear when all are written
/// @param options  whose max_memory_bytes and residuals do not count
/// @throws Error usage for what missing_in_blocks() names, or a depth below 7; invalid_input if the file cannot be read in parts;
///         over_limit if one cell with its ring does not fit, which says how much would do;
///         device_unavailable, empty_result, no_normals, output_not_written, interrupted
FilesReport reconstruct_files(const std::vector<std::string>& inputs, const std::string& output,
                              const Options& options = {}, const ScaleOptions& scale = {});

/// What reconstruct_files() would take.
struct FilesPlan {
  std::int64_t points = 0;        ///< that are used
  int blocks = 0;                 ///< one after another
  int coarse_level = 0;           ///< levels of the octree up to this one are there as a whole
  int ring = 0;                   ///< cells of that level around each block
  double overlap = 1;             ///< nodes of all blocks with their rings, over those of the whole octree
  int passes = 0;                 ///< over all blocks, each of which reads their samples
  std::int64_t memory_bytes = 0;  ///< of the coarse levels and the largest block with its ring
  std::int64_t temp_bytes = 0;    ///< about the most that lies in the temporary folder at once, with the mesh
};

/// Places and sorts the points and divides the octree as reconstruct_files() does, and stops there: a twentieth of its time, and
/// 80 bytes a point of temporary data. Nothing is written.
/// @throws Error as reconstruct_files()
FilesPlan plan_files(const std::vector<std::string>& inputs, const Options& options = {},
                     const ScaleOptions& scale = {});

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
