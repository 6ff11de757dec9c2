// Points as named columns, wherever they lie, and their way into a Cloud. All readers end here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "exec/cpu.hpp"
#include "io/scalar.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Coordinates of larger magnitude count as non-finite: differences of the others always fit into float.
inline constexpr double kLargestCoordinate = 1e38;

/// One value per point at equal distances in memory. Does not own it.
struct Column {
  std::string name;
  Scalar declared = Scalar::float64;  ///< type in the file; decides on the attribute's type
  Scalar stored = Scalar::float64;    ///< type in memory, double for coordinates in text; decides on the shift
  const char* data = nullptr;
  std::int64_t stride_bytes = 0;
  bool swapped = false;  ///< big endian
};

struct PointTable {
  std::int64_t rows = 0;
  std::vector<Column> columns;
};

/// Columns that a parser fills value by value: double for coordinates, float for everything else.
class ParsedColumns {
 public:
  /// Adds a column; the names x, y and z keep double.
  void add(const std::string& name, Scalar declared);

  /// Takes the memory: 8 bytes a row for a coordinate, 4 for any other column.
  void allocate(std::int64_t rows);

  void set(std::size_t column, std::int64_t row, double value) {
    Storage& to = columns_[column];
    if (to.wide.empty())
      to.narrow[static_cast<std::size_t>(row)] = to_float(value);
    else
      to.wide[static_cast<std::size_t>(row)] = value;
  }

  /// Gives a column another name and type after its values have been seen.
  void redeclare(std::size_t column, const std::string& name, Scalar declared);

  /// True if the column holds nothing but whole numbers in 0..255. Not for coordinates.
  [[nodiscard]] bool holds_bytes(std::size_t column) const;
  /// True if some value of the column is larger than `limit`. Not for coordinates.
  [[nodiscard]] bool exceeds(std::size_t column, float limit) const;

  [[nodiscard]] std::size_t size() const noexcept { return columns_.size(); }
  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }

  /// Views of the columns, valid while this lives.
  [[nodiscard]] PointTable table() const;

 private:
  struct Storage {
    std::string name;
    Scalar declared;
    bool is_wide;
    std::vector<double> wide;
    std::vector<float> narrow;
  };

  std::int64_t rows_ = 0;
  std::vector<Storage> columns_;
};

/// True for "x", "y" and "z".
bool is_coordinate(const std::string& name);

/// Turns columns into a cloud: x, y, z (all three are needed); nx, ny, nz or normal_x, normal_y, normal_z where all
/// three are there; every other column becomes an attribute, uint8 if declared so. Rows with a non-finite coordinate
/// are left out and counted. The origin is chosen as ReadOptions::shift says.
/// Two parallel passes over the coordinates, one over the rest. Deterministic for any number of threads.
/// @throws Error invalid_input without x, y, z; usage if `shift` is not finite
Cloud assemble(exec::Cpu& ex, const Source& source, const PointTable& table, const std::optional<Vec3d>& shift);

}  // namespace pointskin::io
