// A cloud in blocks against the whole: clouds, options and divisions of all kinds, chosen by a seed.
#pragma once

#include <cstdint>
#include <string>

#include <pointskin/device.hpp>

namespace pointskin::test {

/// What was compared.
struct BlocksCompared {
  std::string cloud, options;  ///< in words
  int divisions = 0;           ///< into blocks, each of which gave the whole
  bool is_cut = false;         ///< the surface was trimmed
};

/// Reconstructs one cloud as a whole on the CPU and, on `device`, in 1, 2, 3, 4 and 7 blocks below a coarse level 2 to 5 above
/// the finest, `divisions` of these, every second one by 2 to 4 ranks, and expects the same vertices, normals, density, triangles, warnings' counts and trim.
/// Scans of ../shared/data are among the clouds where they are there.
BlocksCompared compare_blocks(std::uint64_t seed, int divisions, const Device& device);

}  // namespace pointskin::test
