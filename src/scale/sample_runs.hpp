// Which samples of a sorted cloud a block takes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scale/cell_set.hpp"

namespace pointskin::scale {

/// Samples begin..end - 1 of a cloud in the order of its keys.
struct SampleRun {
  std::int64_t begin = 0, end = 0;
};

/// The samples in the cells of a set: what is read of a sorted cloud for a block.
///
/// @param cells  (n) keys of the cells of the set's level that hold samples, ascending
/// @param first  (n + 1) place of the first sample of each, and the number of all samples
/// @returns runs that are apart, ascending. O(n log columns)
std::vector<SampleRun> runs_in(const CellSet& set, std::span<const std::uint64_t> cells,
                               std::span<const std::int64_t> first);

}  // namespace pointskin::scale
