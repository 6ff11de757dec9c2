// The header of a PLY file. Source: G. Turk, "The PLY Polygon File Format", Stanford, 1994.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/scalar.hpp"
#include "io/source.hpp"

namespace pointskin::io {

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  AttributeType type = AttributeType::float32;  ///< of the value, or of a list's items
  bool is_list = false;
  AttributeType count_type = AttributeType::uint8;  ///< of a list's length; an integer
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  /// Bytes of a binary row whose lists are all empty.
  [[nodiscard]] std::size_t smallest_row_bytes() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;        ///< byte after the header
  std::int64_t body_line = 1;  ///< line after the header

  [[nodiscard]] const PlyElement* find(const std::string& name) const;
};

/// What PLY calls a type: "char", "uchar", ..., "double". It has no integers of 64 bits.
const char* ply_name_of(AttributeType type);

/// True if `bytes` start as a PLY file does.
bool is_ply(std::string_view bytes);

/// True if the header at `start`, of which the end may be cut off, has a line "element face N" with N > 0.
bool ply_announces_faces(std::string_view start);

/// Parses the header and compares every count with the bytes that are left.
/// @throws Error invalid_input with the line if it is garbled, or if the body cannot hold what it promises
PlyHeader parse_ply_header(const Source& source);

}  // namespace pointskin::io
