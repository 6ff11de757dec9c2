// Points in a file as rows that are read in parts: for clouds that memory does not hold.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/cpu.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// For many threads at once, each with a buffer of its own.
class PointRows {
 public:
  using Bytes = std::vector<char>;

  PointRows() = default;
  virtual ~PointRows() = default;
  PointRows(const PointRows&) = delete;
  PointRows& operator=(const PointRows&) = delete;

  [[nodiscard]] virtual std::int64_t rows() const = 0;
  /// About as many bytes as are read for a row and take its place in a buffer.
  [[nodiscard]] virtual std::int64_t row_bytes() const = 0;

  /// Rows first .. first + count - 1 as a table whose columns lie in `buffer`.
  /// @throws Error invalid_input if the file has become shorter, cannot be read, or is garbled there
  virtual PointTable read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const = 0;
};

}  // namespace pointskin::io
