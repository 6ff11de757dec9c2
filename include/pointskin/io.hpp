// Reading clouds and meshes from files, writing meshes to files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin {

struct ReadOptions {
  /// Offset to subtract from every coordinate before float is used. Unset ("auto"): zero if float keeps the
  /// coordinates exact enough (largest magnitude below 1000 times the extent, or the file itself holds floats), else
  /// the whole-number centre of the bounding box.
  std::optional<Vec3d> shift;
  int threads = 0;  ///< CPU threads, 0: all
};

/// Reads an oriented cloud. PLY (ascii, binary little and big endian, any property types, extra elements and lists
/// skipped), XYZ, PTS, ASC, TXT, CSV text (3 columns: xyz; 4: xyz + scalar; 6: xyz + normal, or xyz + rgb when all
/// three are whole numbers in 0..255 and some exceed 1; 7: xyz + scalar + rgb; 9: xyz + rgb + normal). The format is
/// taken from the content ("ply" magic), else from the extension. `path` "-" reads stdin.
/// Coordinates are read as double; points with a non-finite coordinate are dropped and counted in Cloud::dropped;
/// a non-finite normal becomes a zero normal. Every extra scalar property travels by name.
/// O(n); memory: the cloud plus the mapped file. Deterministic for any thread count.
/// @throws Error invalid_input with file and line or byte, when the file is missing, empty, truncated or garbled.
///         Counts are compared with the file's size before memory is taken.
Cloud read_cloud(const std::string& path, const ReadOptions& options = {});

/// Reads a triangle mesh: PLY (as above, polygons are fanned), OBJ, STL (binary and ascii, equal corners merged), OFF.
/// @throws Error invalid_input as read_cloud, also for an index out of range
Mesh read_mesh(const std::string& path, const ReadOptions& options = {});

/// Writes `mesh`; the format follows the extension: .ply (binary little endian, `list uchar int vertex_indices`), .obj,
/// .stl (binary). `path` "-" writes PLY to stdout. Vertices are float, or double when mesh.origin is not zero.
/// The file appears by atomic rename from a temporary file in the same folder: on any failure the old file, or none, is
/// there. A symbolic link is followed; permissions of an existing file are kept; special files (/dev/null, pipes) are written directly.
/// @throws Error output_not_written (with the reason of the operating system), usage for an unknown extension
void write_mesh(const std::string& path, const Mesh& mesh, int threads = 0);

/// Writes `cloud` as binary PLY (positions, normals, attributes); the same promises as write_mesh.
void write_cloud(const std::string& path, const Cloud& cloud, int threads = 0);

/// Replaces the file `path` by `bytes` atomically (see write_mesh).
/// @throws Error output_not_written
void write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace pointskin
