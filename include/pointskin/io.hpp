// Reading clouds and meshes from files, writing meshes to files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

struct ReadOptions {
  /// Offset to subtract from every coordinate before float is used. Unset ("auto"): zero if float keeps the
  /// coordinates exact enough (largest magnitude below 1000 times the extent), else the centre of the bounding box, in
  /// whole numbers unless the extent is so small that these are not near enough. Where a few strays stretch the box so
  /// far that the offset for all would not be exact enough for the others, it is chosen for the others. Binary floats
  /// are shifted, too: what is worked out between them needs digits that they have not. Only where all are at one place
  /// they stay.
  std::optional<Vec3d> shift;
  int threads = 0;  ///< CPU threads, 0: all
};

/// Reads an oriented cloud. PLY (ascii, binary little and big endian, any property types, extra elements and lists
/// skipped), XYZ, PTS, ASC, TXT, CSV text (3 columns: xyz; 4: xyz + scalar; 6: xyz + normal, or xyz + rgb when all
/// three are whole numbers in 0..255 and some exceed 1; 7: xyz + scalar + rgb; 9: xyz + rgb + normal, or xyz + normal +
/// rgb where only that fits; any number when a first line or comment names the columns), legacy VTK (ascii and binary;
/// the points of POLYDATA and UNSTRUCTURED_GRID; the components of a vector v are v_x, v_y and v_z), JSON ([[x, y, z],
/// ...]), LAS 1.0 to 1.4 and LAZ, PCD (ascii, binary, binary_compressed), NPY, NPZ, PTX, E57, BNPTS, BGEO and XYZ of
/// bare floats, and the vertices of OBJ, STL, OFF, GLB, GLTF, VTP, VTU and NPZ (below); docs/formats.md has the table.
/// The format is taken from the content where it begins with a magic number, else from the extension, else (no
/// extension) from the content again. `path` "-" reads stdin. Coordinates are read as double; points with a coordinate
/// that is not finite or larger than 1e38 are dropped and counted in Cloud::dropped; a non-finite normal becomes a zero
/// normal. Every extra scalar property travels by name and in the type of the file, all integers of VTK with 64 bits
/// included; VTK's color_scalars are uint8 red, green, blue and alpha. Colours of OBJ vertices (`v x y z r g b`, all of
/// them) are uint8 red, green and blue if they are shares of 1 or whole numbers in 0..255, else float32. Text has no
/// types: whole numbers in 0..255 named red, green, blue or alpha are uint8; whole numbers under a name that sounds
/// like a label's are int32 if they fit; all else is float32 if the shortest decimals of the floats are the numbers
/// that are written, else float64. O(n); memory: the cloud plus the mapped file, for text also what its columns need
/// (double for coordinates and for what float32 does not hold). Deterministic for any thread count. The file must not
/// be shortened while it is read.
/// @throws Error invalid_input with file and line or byte, when the file is missing, empty, truncated or garbled.
///         Counts are compared with the file's size before memory is taken.
Cloud read_cloud(const std::string& path, const ReadOptions& options = {});

/// Reads a triangle mesh: PLY (as above, polygons are fanned), OBJ, STL (binary and ascii, equal corners merged), OFF,
/// legacy VTK (polygons, strips, and cells of a grid that are made of triangles), NPZ (vertices and faces), VTP, VTU,
/// GLB and GLTF (all triangles of the scene, where its nodes put them; COLOR_0 is red, green and blue; attributes of
/// applications lose the underscore; buffers as data: URIs or files in the same folder; quantised values and
/// meshoptimizer's coding are understood, Draco's is not). Normals get unit length; those of OBJ are taken if every
/// corner names the normal with the number of its vertex. Attributes have the types that read_cloud gives them.
/// @throws Error invalid_input as read_cloud, also for an index out of range or a vertex that is not finite;
///         over_limit for more than 2^31 - 1 vertices
Mesh read_mesh(const std::string& path, const ReadOptions& options = {});

struct WriteOptions {
  /// PLY as text, numbers in the fewest digits that read back equal; OBJ is text always, STL never.
  bool ascii = false;
  int threads = 0;  ///< CPU threads, 0: all
  /// PLY with coordinates as double also where the origin is zero, for programs that expect them so.
  bool double_coordinates = false;
  /// GLB a quarter as large: positions of 16 bits (a 65,535th of the longest side of the box), normals of 12, and
  /// meshoptimizer's coding (KHR_mesh_quantization, EXT_meshopt_compression). Vertices and triangles keep their order.
  /// Other formats are written as ever. Made as a whole, in memory. Error usage in a build without meshoptimizer.
  bool compress = false;
};

/// Writes `mesh`; the format follows the extension: .ply (binary little endian, `list uchar int vertex_indices`), .obj,
/// .stl (binary), .off (text, with normals and uint8 colours), .glb (glTF 2.0, the origin as the node's translation,
/// all attributes; integers of 32 and 64 bits as floats), .vtp and .vtu (VTK's XML, all attributes), .3mf (3MF; uint8
/// colours), .npz (NumPy's arrays vertices, faces, normals, rgb and every attribute in its type). `path` "-" writes PLY
/// to stdout. Vertices are float, or double when mesh.origin is not zero. PLY holds every attribute in its type, bit
/// for bit, but: integers of 64 bits are int or uint if those hold all of them, else double, which rounds beyond 2^53;
/// labels (is_label) of which some are missing are float or double with NaN, and where other integers are missing there
/// is 0. The file appears by atomic rename from a temporary file in the same folder: on any failure the old file, or
/// none, is there. A symbolic link is followed; permissions of an existing file are kept; special files (/dev/null,
/// pipes) are written directly. OBJ and STL hold world coordinates, OBJ also uint8 red, green and blue as `v x y z r g
/// b` with colours in [0, 1], and no other attributes. A name without an extension is refused unless it is a special
/// file, which gets PLY.
/// @throws Error output_not_written (with the reason of the operating system); usage for an unknown extension or arrays
///         that do not fit together; invalid_input for a triangle that names a vertex that does not
///         exist, and for a vertex, a normal of a mesh, a point or an origin that is not finite
void write_mesh(const std::string& path, const Mesh& mesh, int threads = 0);
void write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options);

/// The same of a mesh in the memory of `workspace`'s device. Binary PLY without attributes is fetched block by block while
/// it is written, so that the host never holds the mesh; all else is downloaded first. The same bytes as the mesh of the
/// host. Waits; O(v + t), two blocks of 2^14 rows a thread on the host.
/// @throws Error as write_mesh, usage where there are not as many normals as vertices. What is not finite or names no
///         vertex is found while it is written: a file is then what it was, a stream has what came before
void write_mesh(const std::string& path, const Workspace& workspace, const DeviceMesh& mesh,
                const WriteOptions& options = {});

/// Writes `cloud` as PLY, or in the format of its extension if that holds clouds; the same promises as write_mesh.
void write_cloud(const std::string& path, const Cloud& cloud, int threads = 0);
void write_cloud(const std::string& path, const Cloud& cloud, const WriteOptions& options);

/// Replaces the file `path` by `bytes` atomically (see write_mesh); "-" is stdout.
/// @throws Error output_not_written
void write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace pointskin
