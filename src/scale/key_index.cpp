#include "scale/key_index.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace pointskin::scale {

SampleRun KeyIndex::samples_in(const octree::Coordinates& cell, int depth) const {
  const std::int32_t side = std::int32_t{1} << depth;
  if (std::min({cell.x, cell.y, cell.z}) < 0 || std::max({cell.x, cell.y, cell.z}) >= side) return {};
  const std::uint64_t key = octree::encode(cell);
  const int coarser = std::min(depth, level_);
  const std::uint64_t begin = key >> 3 * (depth - coarser) << 3 * (level_ - coarser);
  const std::uint64_t end = begin + (std::uint64_t{1} << 3 * (level_ - coarser));
  const auto place = [&](std::uint64_t from) {
    return static_cast<std::size_t>(std::lower_bound(cells_.begin(), cells_.end(), from) - cells_.begin());
  };
  const SampleRun held{first_[place(begin)], first_[place(end)]};
  if (depth <= level_ || held.begin == held.end) return held;
  const std::int64_t first = first_from(held, key, depth);
  return {first, first_from({first, held.end}, key + 1, depth)};
}

std::int64_t KeyIndex::first_from(SampleRun among, std::uint64_t cell, int depth) const {
  std::array<std::uint64_t, 512> keys{};
  while (among.end - among.begin > std::ssize(keys)) {
    const std::int64_t middle = among.begin + (among.end - among.begin) / 2;
    cloud_.read(middle, 1, {.keys = keys.data()});
    (octree::cell_key(keys[0], depth) < cell ? among.begin : among.end) = middle;
  }
  const std::int64_t count = among.end - among.begin;
  cloud_.read(among.begin, count, {.keys = keys.data()});
  return among.begin + (std::partition_point(keys.begin(), keys.begin() + count,
                                             [&](std::uint64_t key) { return octree::cell_key(key, depth) < cell; }) -
                        keys.begin());
}

}  // namespace pointskin::scale
