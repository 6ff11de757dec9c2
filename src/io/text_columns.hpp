// What the columns of a text of points mean.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>

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

/// @throws Error invalid_input if the file promises another number of points, or cannot hold as many values
void check_rows(const Source& source, const TextLayout& layout, std::int64_t rows);

/// Names of the columns before their values are known; those without names are called x, y, z, "3", "4", ...
/// @throws Error invalid_input for a number of columns that has no agreed meaning, or names without x, y, z
std::vector<std::string> column_names(const Source& source, const TextLayout& layout);

/// What the numbers of columns are, found out as they are read: by several threads at once, and the same whatever
/// their order.
class SeenValues {
 public:
  explicit SeenValues(const TextLayout& layout);

  /// Takes a value of the column into account.
  void see(std::size_t column, double value) {
    if (columns_[column].may_be_colour) look_for_bytes(columns_[column], value);
    if (columns_[column].may_be_scalar) look_for_digits(columns_[column], value);
  }

  /// Of columns that may hold colours: nothing but whole numbers in 0..255; such, and some are larger than 1.
  [[nodiscard]] bool are_bytes(std::size_t column) const;
  [[nodiscard]] bool are_bytes_over_one(std::size_t column) const;

  /// True for columns that may become attributes other than colours.
  [[nodiscard]] bool may_be_scalar(std::size_t column) const { return columns_[column].may_be_scalar; }
  /// Of those: int32 if the column's name sounds like a label's and all its values are whole and fit; else float64 if float32
  /// would lose digits that are written: the shortest decimal of its float32 is another number; else float32.
  [[nodiscard]] AttributeType scalar_type(std::size_t column) const;
  /// True if float does not hold them.
  [[nodiscard]] bool exceed_float(std::size_t column) const;

 private:
  /// Flags are only ever set.
  struct Column {
    std::atomic<bool> loses_digits = false, inexact = false, no_int32 = false, no_bytes = false, over_one = false;
    bool may_be_label = false, may_be_colour = false, may_be_scalar = false;
  };

  static void look_for_bytes(Column& column, double value);
  static void look_for_digits(Column& column, double value);

  std::vector<Column> columns_;
};

struct TextColumn {
  std::string name;
  AttributeType type = AttributeType::float32;
};

/// Once the values are known: names for what had none, and types: whole numbers in 0..255 under a colour's name are uint8.
/// @throws Error as column_names(), and if colours are expected and are none
std::vector<TextColumn> describe_columns(const Source& source, const TextLayout& layout, const SeenValues& seen);

}  // namespace pointskin::io
