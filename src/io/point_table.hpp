// Points as named columns, wherever they lie, and their way into a Cloud. All readers end here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "core/box.hpp"
#include "exec/cpu.hpp"
#include "io/scalar.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Coordinates of larger magnitude count as non-finite: differences of the others always fit into float.
inline constexpr double kLargestCoordinate = 1e38;

/// One value per point at equal distances in memory. Does not own it.
struct Column {
  std::string name;
  AttributeType declared = AttributeType::float64;  ///< that an attribute gets
  AttributeType stored = AttributeType::float64;    ///< in memory, double for coordinates in text; decides on the shift
  const char* data = nullptr;
  std::int64_t stride_bytes = 0;
  bool swapped = false;  ///< big endian
};

struct PointTable {
  std::int64_t rows = 0;
  std::vector<Column> columns;
  double resolution = 0;  ///< world units between coordinates that the file tells apart; 0: unknown
};

/// True if it has nx, ny, nz or normal_x, normal_y, normal_z.
bool has_normals(const PointTable& table);

/// True for "x", "y" and "z".
bool is_coordinate(const std::string& name);

/// Turns columns into a cloud: x, y, z (all three are needed); nx, ny, nz or normal_x, normal_y, normal_z where all
/// three are there; every other column becomes an attribute of the type that it is declared as. A column that is stored
/// otherwise must hold nothing but values of that type. Rows with a non-finite coordinate are left out and counted. The
/// origin is chosen as ReadOptions::shift says. Two parallel passes over the coordinates, one over the rest.
/// Deterministic for any number of threads.
/// @throws Error invalid_input without x, y, z; usage if `shift` is not finite
Cloud assemble(exec::Cpu& ex, const Source& source, const PointTable& table, const std::optional<Vec3d>& shift);

/// Positions of all rows relative to `origin`, as assemble() has them, for rows that are finite.
/// @param out  shape (rows)
/// @throws Error invalid_input without x, y, z
void read_positions(const PointTable& table, const Source& source, const Vec3d& origin, Vec3f* out);

/// The origin that assemble() chooses, for a table that comes in parts. 48 bytes for 64 rows.
class OriginSearch {
 public:
  /// Parts come in the order of their rows; all but the last have a multiple of kRunRows rows.
  /// @returns how many of its points are finite
  std::int64_t add(exec::Cpu& ex, const Source& source, const PointTable& part);

  /// @param beyond  returns all points of all parts that are outside of a box, in any order; seldom called
  [[nodiscard]] Vec3d origin(const std::function<std::vector<Vec3d>(const Box&)>& beyond) const;

 private:
  std::vector<Box> runs_;
  std::int64_t points_ = 0;
  double resolution_ = 0;
  bool has_digits_ = false;
};

/// Finite points of a table that are outside of a box, in the order of the rows.
std::vector<Vec3d> points_beyond(exec::Cpu& ex, const Source& source, const PointTable& table, const Box& box);

}  // namespace pointskin::io
