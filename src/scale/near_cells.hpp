// Where the sample nearest to a point may lie, in a cloud that memory does not hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin::scale {

/// The cells of a level that hold samples, as a tree that needs no memory of its own: cells below another one follow each other.
class NearCells {
 public:
  /// @param level  of the cells
  /// @param cells  (n) their Morton keys, ascending; they outlive this
  NearCells(int level, std::span<const std::uint64_t> cells) : level_(level), cells_(cells) {}

  /// Places of cells that may hold the sample nearest to a point of the unit cube, or one as near: no other cell does, whatever the
  /// samples. Ascending. O(cells as near as the nearest one's far corner, log n each)
  [[nodiscard]] std::vector<std::int64_t> around(const Vec3f& point) const;

 private:
  class Search;
  int level_;
  std::span<const std::uint64_t> cells_;
};

}  // namespace pointskin::scale
