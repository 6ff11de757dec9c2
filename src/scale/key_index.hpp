// Which samples of a sorted cloud lie in a cell, of any level.
#pragma once

#include <cstdint>
#include <span>

#include "octree/keys.hpp"
#include "scale/sample_runs.hpp"
#include "scale/sorted_cloud.hpp"

namespace pointskin::scale {

/// Finds the samples of single cells: in memory down to a level K, and below it on the disk.
class KeyIndex {
 public:
  /// @param level  K
  /// @param cells  (n) of this level that hold samples, ascending; what it refers to must outlive the index
  /// @param first  (n + 1) first sample of each, and the number of all
  KeyIndex(const SortedCloud& cloud, int level, std::span<const std::uint64_t> cells,
           std::span<const std::int64_t> first)
      : cloud_(cloud), level_(level), cells_(cells), first_(first) {}

  /// Samples in a cell; none beyond the cube. For many threads at once.
  /// @param depth  of the cell, 0 to octree::kPointBits
  /// @throws Error as SortedCloud::read
  /// O(log cells), and below K O(log samples) reads
  [[nodiscard]] SampleRun samples_in(const octree::Coordinates& cell, int depth) const;

 private:
  /// The first sample whose cell of this depth is not before `cell`, from samples of a cell of level K.
  [[nodiscard]] std::int64_t first_from(SampleRun among, std::uint64_t cell, int depth) const;

  const SortedCloud& cloud_;
  int level_;
  std::span<const std::uint64_t> cells_;
  std::span<const std::int64_t> first_;
};

}  // namespace pointskin::scale
