// What `pointskin bench` prints: the paper's table, and programs side by side.
#pragma once

#include <string>

#include "bench/results.hpp"

namespace pointskin::cli {

/// Titles of the columns of memory_row; `name_width` is that of the longest name of a cloud.
std::string memory_header(std::size_t name_width);

/// Medians: milliseconds for octree, function (splat and solve), surface and total; memory; frames per second.
std::string memory_row(const Results& results, const MemoryRun& run, std::size_t name_width);

/// All runs file to file: median, least and largest wall clock, peak memory, and how many times faster than the peer.
std::string file_table(const Results& results, std::size_t name_width);

}  // namespace pointskin::cli
