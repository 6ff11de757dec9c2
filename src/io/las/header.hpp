// The headers of LAS files. Source: ASPRS, "LAS Specification", 1.4 - R15, and those of 1.0 to 1.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/vector.hpp>

#include "io/source.hpp"

namespace pointskin::io {

/// A value that a program adds to every point, as the record "Extra Bytes" describes it.
struct LasExtra {
  std::string name;
  AttributeType type = AttributeType::uint8;
  std::size_t offset = 0;       ///< bytes before it in a point
  double scale = 1, shift = 0;  ///< value = scale * stored + shift
  [[nodiscard]] bool is_scaled() const { return scale != 1 || shift != 0; }
};

struct LasHeader {
  int minor = 0;   ///< of the version 1.x
  int format = 0;  ///< of the points, 0 to 10
  bool is_compressed = false;
  std::size_t point_bytes = 0;
  std::size_t body = 0;  ///< where the points begin
  std::uint64_t points = 0;
  Vec3d scale{1, 1, 1}, offset{0, 0, 0};
  std::vector<LasExtra> extras;
  std::string_view compression;  ///< the record of LASzip; empty: there is none
};

/// What points of the format 0 to 10 hold, and where.
struct LasFormat {
  std::size_t bytes = 0;     ///< without extra ones
  bool is_extended = false;  ///< formats 6 to 10: fields of other widths
  std::optional<std::size_t> time, colour, infrared, wave;
};

/// @param format  0 to 10
LasFormat las_format(int format);

/// True if the file starts as LAS and LAZ do.
bool is_las(std::string_view start);

/// Reads the header and the records after it. `source` must outlive it.
/// @throws Error invalid_input for a version, a format or lengths that cannot be
LasHeader parse_las_header(const Source& source);

}  // namespace pointskin::io
