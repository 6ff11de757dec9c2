#include "scale/sample_runs.hpp"

#include <algorithm>

#include <cstddef>

namespace pointskin::scale {

std::vector<SampleRun> runs_in(const CellSet& set, std::span<const std::uint64_t> cells,
                               std::span<const std::int64_t> first) {
  std::vector<SampleRun> runs;
  if (set.empty()) return runs;
  auto i = static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), set.first_key()) - cells.begin());
  for (; i < cells.size() && cells[i] <= set.last_key(); ++i) {
    if (first[i] == first[i + 1] || !set.contains(octree::decode(cells[i]))) continue;
    if (!runs.empty() && runs.back().end == first[i])
      runs.back().end = first[i + 1];
    else
      runs.push_back({first[i], first[i + 1]});
  }
  return runs;
}

}  // namespace pointskin::scale
