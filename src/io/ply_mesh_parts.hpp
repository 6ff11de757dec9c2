// A mesh in a binary PLY file, read in parts: for meshes that memory does not hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/input.hpp"
#include "io/ply_header.hpp"
#include "io/ply_triangle_rows.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// Positions and triangles as read_mesh() gives them, with the origin that it chooses. Its members may be called by many
/// threads at once, each with a buffer of its own.
class PlyMeshParts {
 public:
  using Bytes = std::vector<char>;

  /// @returns null if the file cannot be read in parts: no regular file, no binary PLY, no vertices, some with lists, or
  ///          faces whose number of bytes shows that some are no triangles
  /// @throws Error invalid_input if it cannot be read, or its header is garbled
  static std::unique_ptr<PlyMeshParts> open(const std::string& path);

  [[nodiscard]] std::int64_t vertices() const { return vertex_.count; }
  [[nodiscard]] std::int64_t triangles() const { return face_count_; }
  /// Of a vertex in the file.
  [[nodiscard]] std::int64_t vertex_bytes() const { return static_cast<std::int64_t>(vertex_.smallest_row_bytes()); }
  /// Of a triangle in the file.
  [[nodiscard]] std::int64_t triangle_bytes() const { return static_cast<std::int64_t>(rows_.row_bytes); }
  [[nodiscard]] std::int64_t file_bytes() const { return static_cast<std::int64_t>(input_.source().bytes.size()); }

  /// Chooses the origin: one pass over the vertices, or two; 48 bytes for 64 of them, and kBufferBytes.
  /// @throws Error invalid_input if one is not finite, or there is no x, y or z
  void find_origin(exec::Cpu& ex);

  /// Positions relative to the origin, which must have been found.
  /// @param out  shape (count)
  /// @throws Error invalid_input if the file has become shorter
  void read_vertices(std::int64_t first, std::int64_t count, Bytes& buffer, Vec3f* out) const;

  /// @param out  shape (count)
  /// @throws Error invalid_input for an index out of range, or if the file has become shorter; over_limit for a face
  ///         that is no triangle
  void read_triangles(std::int64_t first, std::int64_t count, Bytes& buffer, Triangle* out) const;

  static constexpr std::int64_t kBufferBytes = std::int64_t{1} << 20;

 private:
  explicit PlyMeshParts(const std::string& path) : input_(path) {}
  /// Rows of the file as a table of x, y and z, in `buffer`.
  PointTable vertex_rows(std::int64_t first, std::int64_t count, Bytes& buffer) const;

  Input input_;  // the header is read from the mapping, the rest is not
  PlyEncoding encoding_ = PlyEncoding::little_endian;
  PlyElement vertex_;
  std::size_t vertices_at_ = 0;
  Vec3d origin_{0, 0, 0};
  TriangleRows rows_;
  std::int64_t face_count_ = 0;
  std::size_t faces_at_ = 0;
};

}  // namespace pointskin::io
