// Meshes and clouds as bytes, in blocks. What the blocks hold depends on the data alone. The data must outlive them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/workspace.hpp>

#include "io/output.hpp"

namespace pointskin::io {

/// What PLY stores per vertex, of a cloud or of a mesh.
struct VertexArrays {
  const Vec3d& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Attribute>& attributes;
  bool asks_for_double = false;

  /// True if coordinates are written as double.
  [[nodiscard]] bool is_wide() const { return asks_for_double || origin[0] != 0 || origin[1] != 0 || origin[2] != 0; }
};

/// @throws Error usage if an attribute has not as many values as there are vertices
void check_attributes(const VertexArrays& vertices);

/// The attributes red, green and blue, and alpha where it is wanted and there, if they are uint8 and nothing is missing in
/// them; else none. For formats that have colours as one array.
std::vector<const Attribute*> byte_colours(const std::vector<Attribute>& attributes, bool with_alpha);

/// PLY, binary or ascii as `options` want it. @throws Error as format_ply
Blocks format_ply_cloud(const Cloud& cloud, const WriteOptions& options);
Blocks format_ply_mesh(const Mesh& mesh, const WriteOptions& options);

/// Binary little endian PLY. `triangles` null: no face element. Coordinates are double, and in world units, if the
/// origin is not zero.
/// @throws Error usage if an array has the wrong length or a name comes twice
Blocks format_ply(const VertexArrays& vertices, const std::vector<Triangle>* triangles);

/// A mesh whose arrays are fetched part by part, by any thread. Each function fills `part` with elements [first, last).
struct MeshParts {
  Vec3d origin{0, 0, 0};
  std::int64_t vertices = 0, triangles = 0;
  std::function<void(std::size_t first, std::size_t last, std::vector<Vec3f>& part)> positions{};
  std::function<void(std::size_t first, std::size_t last, std::vector<Vec3f>& part)> normals{};  ///< may be empty
  std::function<void(std::size_t first, std::size_t last, std::vector<Triangle>& part)> corners{};
  struct AttributeParts {
    std::string name;
    AttributeType type = AttributeType::float32;
    std::function<AttributeValues(std::size_t first, std::size_t last)> values{};
  };
  std::vector<AttributeParts> attributes{};
};

/// Binary little endian PLY of such a mesh, the same bytes as format_ply() makes. Where the data are wrong, making a block throws.
Blocks format_ply_parts(const MeshParts& mesh, bool double_coordinates);

/// The same of a mesh in the memory of a device, which is fetched block by block; its attributes are left out. Where
/// the data are wrong, making a block throws.
/// @throws Error usage if there are not as many normals as vertices
Blocks format_device_ply(const Workspace& workspace, const DeviceMesh& mesh, bool double_coordinates);

/// The same as ASCII PLY: a line per vertex and face, numbers in the fewest digits that read back equal.
Blocks format_ply_ascii(const VertexArrays& vertices, const std::vector<Triangle>* triangles);

/// The header of either. @param encoding  "ascii" or "binary_little_endian" @throws Error as format_ply
std::string ply_header(const VertexArrays& vertices, const std::vector<Triangle>* triangles, const char* encoding);

/// The types of the properties that hold the attributes: mostly their own (see stored_type in write_ply.cpp).
std::vector<AttributeType> stored_types(const VertexArrays& vertices);

/// OBJ text: world coordinates in the fewest digits that read back equal. Colours, if red, green and blue are uint8
/// attributes, follow the coordinates as numbers in [0, 1], as many programs read them.
Blocks format_obj(const Mesh& mesh, const WriteOptions& options);

/// Binary STL, world coordinates as float.
/// @throws Error over_limit for more than 2^32 - 1 triangles
Blocks format_stl(const Mesh& mesh, const WriteOptions& options);

/// OFF text: world coordinates in the fewest digits that read back equal, normals, and colours if red, green and blue are
/// uint8 attributes.
Blocks format_off(const Mesh& mesh, const WriteOptions& options);

/// glTF 2.0 in one binary file: positions relative to the node's translation, which is the origin; normals; COLOR_0, if
/// red, green and blue are uint8 or uint16 attributes, with alpha where there is one; every other attribute under its
/// name with an underscore in front, 64-bit and 32-bit numbers as floats.
/// @throws Error over_limit for more than 4 GiB, which its lengths do not hold
Blocks format_glb_mesh(const Mesh& mesh, const WriteOptions& options);
Blocks format_glb_cloud(const Cloud& cloud, const WriteOptions& options);

/// 3MF: an archive of XML, in millimetres, with colours if red, green and blue are uint8 attributes. A mesh that is not
/// closed is an object of the type "surface". The archive is made as a whole, in memory.
Blocks format_3mf(const Mesh& mesh, const WriteOptions& options);

/// VTK's XML files: polygons, or an unstructured grid; of a cloud, a vertex for every point. Arrays in binary behind the XML;
/// points in double if there is an origin. Integers of which some are missing are floats with NaN; red, green and blue of
/// uint8 are one array, RGB.
Blocks format_vtp_mesh(const Mesh& mesh, const WriteOptions& options);
Blocks format_vtp_cloud(const Cloud& cloud, const WriteOptions& options);
Blocks format_vtu_mesh(const Mesh& mesh, const WriteOptions& options);
Blocks format_vtu_cloud(const Cloud& cloud, const WriteOptions& options);

/// NumPy's archive of arrays: points or vertices and faces, normals, rgb (if red, green and blue are uint8), and every
/// other attribute under its name and in its type. Integers of which some are missing are floats with NaN. The archive is
/// made as a whole, in memory.
Blocks format_npz_mesh(const Mesh& mesh, const WriteOptions& options);
Blocks format_npz_cloud(const Cloud& cloud, const WriteOptions& options);

/// Rows of a file that are made alike: append(first, last, bytes) adds the rows [first, last) to `bytes`.
struct Section {
  std::size_t rows;
  std::function<void(std::size_t first, std::size_t last, std::string& bytes)> append;
  std::size_t row_bytes = 0;  ///< of each row, if all have as many
};

/// The header, then the sections one after the other, 2^14 rows a block. If all sections have rows of known bytes, the places of the
/// blocks are known.
Blocks cut_into_blocks(std::string header, std::vector<Section> sections);

/// `origin` + `p`.
inline Vec3d world(const Vec3d& origin, const Vec3f& p) {
  return {origin[0] + static_cast<double>(p.x), origin[1] + static_cast<double>(p.y),
          origin[2] + static_cast<double>(p.z)};
}

inline bool is_zero(const Vec3d& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

}  // namespace pointskin::io
