#include "scale/sample_runs.hpp"

#include <cstddef>

namespace pointskin::scale {

std::vector<SampleRun> runs_in(const CellSet& set, std::span<const std::uint64_t> cells,
                               std::span<const std::int64_t> first) {
  std::vector<SampleRun> runs;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (first[i] == first[i + 1] || !set.contains(octree::decode(cells[i]))) continue;
    if (!runs.empty() && runs.back().end == first[i])
      runs.back().end = first[i + 1];
    else
      runs.push_back({first[i], first[i + 1]});
  }
  return runs;
}

}  // namespace pointskin::scale
