// Faces of a binary PLY file that are all triangles, with nothing but scalars around their list: rows of equal length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <pointskin/mesh.hpp>

#include "io/ply_header.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {

struct TriangleRows {
  AttributeType length_type = AttributeType::uint8;  ///< of a list's length
  AttributeType type = AttributeType::int32;         ///< of a corner
  bool swapped = false;                              ///< big endian
  std::size_t length_at = 0;                         ///< byte of a row
  std::size_t row_bytes = 0;

  [[nodiscard]] std::size_t corners_at() const { return length_at + size_of(length_type); }

  /// True if the rows that begin at `data` all have three corners. Row i + 1 lies where the lengths say if row i has.
  [[nodiscard]] bool are_triangles(const char* data, std::int64_t rows) const {
    return visit_type(length_type, [&](auto tag) {
      const char* length = data + length_at;
      for (std::int64_t row = 0; row < rows; ++row, length += row_bytes)
        if (load<decltype(tag)>(length, swapped) != 3) return false;
      return true;
    });
  }

  /// Reads rows. @returns where a corner is that is not in [0, vertices); else null
  const char* read(const char* data, std::int64_t rows, std::int64_t vertices, Triangle* out) const {
    return visit_type(type, [&](auto tag) -> const char* {
      using T = decltype(tag);
      const char* corners = data + corners_at();
      for (std::int64_t row = 0; row < rows; ++row, corners += row_bytes)
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const auto index = static_cast<std::int64_t>(load<T>(corners + corner * sizeof(T), swapped));
          if (index < 0 || index >= vertices) return corners + corner * sizeof(T);
          out[row][corner] = static_cast<std::int32_t>(index);
        }
      return nullptr;
    });
  }
};

/// The rows of an element "face", if all are triangles. @param list  number of the property with the corners
inline std::optional<TriangleRows> triangle_rows_of(const PlyElement& face, std::size_t list, PlyEncoding encoding) {
  std::size_t lists = 0;
  for (const PlyProperty& property : face.properties) lists += property.is_list ? 1 : 0;
  if (lists != 1) return std::nullopt;
  const PlyProperty& property = face.properties[list];
  TriangleRows rows{property.count_type, property.type, encoding == PlyEncoding::big_endian, 0,
                    face.smallest_row_bytes() + 3 * size_of(property.type)};
  for (std::size_t p = 0; p < list; ++p) rows.length_at += size_of(face.properties[p].type);
  return rows;
}

}  // namespace pointskin::io
