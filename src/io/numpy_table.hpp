// Points in arrays of NumPy.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "io/npy.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {

/// Names of the columns of an array.
using ColumnNames = std::array<std::string_view, 4>;
inline constexpr ColumnNames kPositionNames{"x", "y", "z", ""}, kNormalNames{"nx", "ny", "nz", ""};

/// Names that programs give to arrays and fields: of three coordinates, of normals, of colours, of triangles.
bool names_positions(const std::string& name);
bool names_normals(const std::string& name);
bool names_colours(const std::string& name);
bool names_faces(const std::string& name);

/// Columns that lie in arrays, which must outlive it.
class NumpyTable {
 public:
  explicit NumpyTable(std::int64_t rows) : table_{rows, {}} {}

  /// The columns from `first` on.
  void add_vector(const NpyArray& array, std::int64_t first, std::int64_t count, const ColumnNames& names);

  /// Three or four columns of colours. Floats that are shares of one become bytes, as do whole numbers in 0..255.
  void add_colours(const NpyArray& array, std::int64_t first, std::int64_t count);

  /// Columns that get the array's name, numbered if there are several; none of more than 64.
  void add_attributes(const std::string& name, const NpyArray& array);

  /// The fields of a structured array.
  void add_fields(const NpyArray& array);

  [[nodiscard]] const PointTable& table() const { return table_; }

 private:
  [[nodiscard]] Column column(const NpyArray& array, std::int64_t c, std::string name) const;
  void make_bytes(std::size_t first, double factor);

  PointTable table_;
  std::int64_t row_bytes_ = 0;  ///< of a structured array whose fields are added
  std::deque<std::vector<std::uint8_t>> bytes_;
};

/// One array: columns as text files have them, positions, then normals or colours; or fields by their names.
/// @throws Error invalid_input for a number of columns that has no agreed meaning
NumpyTable table_of(const Source& source, const NpyArray& array);

}  // namespace pointskin::io
