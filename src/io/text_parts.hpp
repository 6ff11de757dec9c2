// Points of a text, one a line, read in parts: for clouds that memory does not hold.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "exec/cpu.hpp"
#include "io/input.hpp"
#include "io/lines.hpp"
#include "io/ply_header.hpp"
#include "io/point_rows.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// The values that the readers of the whole find, as doubles of the types that these give them. Pages of the file that have been
/// read do not stay in memory. Lines are counted once, before all else, and parsed each time they are read.
class TextParts final : public PointRows {
 public:
  /// Lines of columns, as parse_text() reads them.
  /// @param input  must outlive this, as below
  /// @throws Error invalid_input as parse_text()
  static std::unique_ptr<TextParts> of_columns(exec::Cpu& ex, const Input& input);

  /// The vertices of a PLY file, which has some and is text.
  /// @throws Error invalid_input if lines are missing
  static std::unique_ptr<TextParts> of_ply(exec::Cpu& ex, const Input& input, const PlyHeader& header);

  [[nodiscard]] std::int64_t rows() const override { return rows_; }
  [[nodiscard]] std::int64_t row_bytes() const override;
  PointTable read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const override;

 private:
  /// Reads the values of a line to its end, and hands them on by the number of their column.
  using SetValue = std::function<void(std::size_t, double)>;
  using ReadRow = std::function<void(Values&, const SetValue&)>;

  TextParts(const Input& input, ReadRow read_row) : input_(input), read_row_(std::move(read_row)) {}

  const Input& input_;
  ReadRow read_row_;
  LineIndex index_;
  std::int64_t first_row_ = 0, rows_ = 0;  ///< of the file's, that hold points
  PointTable table_;                       ///< its columns, without values
};

}  // namespace pointskin::io
