// A table whose columns lie in a file, read in parts: for clouds that memory does not hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/input.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// Rows of a table from the file itself, so that the pages of its mapping do not stay in memory. Values that lie beside
/// each other in a row are read together, columns that lie apart one by one. For many threads at once, each with a
/// buffer of its own.
class TableParts {
 public:
  using Bytes = std::vector<char>;

  /// True if every value of the table is in the bytes of `input`.
  static bool holds(const Input& input, const PointTable& table);

  /// @param input  must outlive this
  /// @param table  that `input` holds
  TableParts(const Input& input, PointTable table);

  [[nodiscard]] std::int64_t rows() const { return table_.rows; }
  /// That are read for a row.
  [[nodiscard]] std::int64_t row_bytes() const;

  /// Rows first .. first + count - 1 as a table whose columns lie in `buffer`.
  /// @throws Error invalid_input if the file has become shorter, or cannot be read
  PointTable read(std::int64_t first, std::int64_t count, Bytes& buffer) const;

 private:
  /// Columns of one distance from row to row, all of whose values of a row lie within it.
  struct Band {
    std::size_t at = 0;  ///< byte of the file at which the first row begins
    std::int64_t width = 0, stride = 0;
    std::vector<std::size_t> columns;
  };

  const Input& input_;
  PointTable table_;
  std::vector<Band> bands_;
};

}  // namespace pointskin::io
