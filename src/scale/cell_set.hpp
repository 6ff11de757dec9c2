// Sets of cells of one level of the octree, which grow by whole cells: what a block of a cloud needs around its own
// cells.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "octree/keys.hpp"

namespace pointskin::scale {

/// A set of cells of one level, as intervals along z in the columns that have any. A surface crosses a column a few
/// times, so that the set is small at any level: 8 bytes an interval and 16 a column.
class CellSet {
 public:
  /// @param level  of the cells, 0 to octree::kMaxDepth
  /// @param keys   Morton keys of cells, in any order; they may repeat. O(n log n)
  CellSet(int level, std::span<const std::uint64_t> keys);

  [[nodiscard]] int level() const { return level_; }
  /// Number of cells. O(intervals)
  [[nodiscard]] std::int64_t size() const;
  /// Keys between which those of all cells lie: [first, last].
  [[nodiscard]] std::uint64_t first_key() const { return octree::encode(lower_); }
  [[nodiscard]] std::uint64_t last_key() const { return octree::encode(upper_); }
  [[nodiscard]] bool empty() const { return columns_.columns.empty(); }
  /// O(log columns)
  [[nodiscard]] bool contains(const octree::Coordinates& cell) const;
  /// The Morton keys of all cells, ascending. O(n log n), 8 bytes a cell
  [[nodiscard]] std::vector<std::uint64_t> keys() const;

  /// All cells of the cube that are at most `reach` cells along each axis from a cell of the set. Time grows with the
  /// columns of the result times `reach`, not with its cells.
  [[nodiscard]] CellSet grown(int reach) const;

 private:
  /// Cells begin..end - 1.
  struct Interval {
    std::int32_t begin = 0, end = 0;
  };
  /// The intervals of a column, which are apart and ascend, begin at `first` and end where those of the next one begin.
  struct Column {
    std::int32_t x = 0, y = 0;
    std::int64_t first = 0;
  };
  /// Columns in ascending order of (x, y).
  struct Columns {
    std::vector<Column> columns;
    std::vector<Interval> intervals;
    [[nodiscard]] std::span<const Interval> of(std::size_t column) const;
  };

  CellSet(Columns columns, int level) : level_(level), columns_(std::move(columns)) { find_box(); }
  void find_box();

  /// The intervals longer by `reach` at both ends, within the cube.
  static Columns grown_along_z(const Columns& from, int reach, std::int32_t side);
  /// Every column with those at most `reach` beside it in y.
  static Columns grown_along_y(const Columns& from, int reach, std::int32_t side);
  /// x and y exchanged.
  static Columns transposed(const Columns& from);
  /// Adds a column of all `intervals`, which may overlap and are sorted here; those that touch become one.
  static void add_column(Columns& to, std::int32_t x, std::int32_t y, std::vector<Interval>& intervals);

  int level_;
  Columns columns_;
  octree::Coordinates lower_{}, upper_{};  ///< of all cells; most that are asked for lie outside
};

}  // namespace pointskin::scale
