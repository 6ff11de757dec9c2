// What the columns of a text of points mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/point_table.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// How a text of points begins.
struct TextLayout {
  std::int64_t header_rows = 0;  ///< rows before the first point: a count, names, or both
  std::int64_t promised = -1;    ///< number of points as the file says; -1 if it does not
  std::int64_t first_line = 0;   ///< of the first point
  std::size_t columns = 0;
  std::vector<std::string> names;  ///< one per column, or none if the file does not name them
};

/// Looks at the first lines of `source`: a single whole number is the number of points (PTS); words are the names of
/// the columns, which a comment right before the first point may hold too ("# x y z nx ny nz", "//X,Y,Z").
/// @throws Error invalid_input if there is no point, or its numbers have decimal commas
TextLayout find_layout(const Source& source);

/// Makes columns for `layout` in `parsed`; columns without names are called x, y, z, "3", "4", ...
/// @throws Error invalid_input for a number of columns that has no agreed meaning, or names without x, y, z
void add_columns(const Source& source, const TextLayout& layout, ParsedColumns& parsed);

/// Once the values are known: names what had no name, and declares whole numbers in 0..255 under a colour's name uint8.
/// @throws Error invalid_input if colours are expected and are none
void name_columns(const Source& source, const TextLayout& layout, ParsedColumns& parsed);

}  // namespace pointskin::io
