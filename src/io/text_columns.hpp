// What the columns of a text of points mean.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/parsed_columns.hpp"
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

/// Names that mean something as PLY writes them: "X" is "x", and "r", "g", "b" are "red", "green" and "blue".
std::vector<std::string> canonical_names(std::vector<std::string> names);

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

/// What the numbers of a column need, found out as they are read: by several threads at once, and the same whatever
/// their order.
class NeededTypes {
 public:
  /// Looks at the columns that may become attributes other than colours.
  explicit NeededTypes(const TextLayout& layout);

  /// Takes a value of the column into account.
  void see(std::size_t column, double value) {
    if (looked_at_[column]) look_at(column, value);
  }

  /// int32 if the column's name sounds like a label's and all its values are whole and fit; else float64 if float32
  /// would lose digits that are written: the shortest decimal of its float32 is another number; else float32.
  [[nodiscard]] AttributeType type_of(std::size_t column) const;
  /// True if float does not hold the values of the column.
  [[nodiscard]] bool exceeds_float(std::size_t column) const;
  [[nodiscard]] bool is_looked_at(std::size_t column) const { return looked_at_[column]; }

 private:
  void look_at(std::size_t column, double value);

  /// Flags are only ever set.
  struct Column {
    std::atomic<bool> loses_digits = false, inexact = false, no_int32 = false;
    bool may_be_label = false;
  };

  std::vector<bool> looked_at_;
  std::vector<Column> columns_;
};

}  // namespace pointskin::io
