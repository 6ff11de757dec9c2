// A table whose columns lie in a file, read in parts: for clouds that memory does not hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/input.hpp"
#include "io/point_rows.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// Rows of a table from the file itself, so that the pages of its mapping do not stay in memory. Values that lie beside
/// each other in a row are read together, columns that lie apart one by one.
class TableParts final : public PointRows {
 public:
  /// True if every value of the table is in the bytes of `input`.
  static bool holds(const Input& input, const PointTable& table);

  /// @param input  must outlive this
  /// @param table  that `input` holds
  TableParts(const Input& input, PointTable table);

  [[nodiscard]] std::int64_t rows() const override { return table_.rows; }
  [[nodiscard]] std::int64_t row_bytes() const override;
  PointTable read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const override;

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
