// Where the cells of a level, in Morton order, are cut into blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pointskin::scale {

/// Cuts cells into `blocks` runs so that the heaviest run is as light as cuts between cells allow.
///
/// @param loads   (n) what each cell costs, at least 0, in an order in which blocks are to have neighbours together
/// @param blocks  at least 1
/// @returns  (blocks + 1) where each block begins, and n: block i has cells [result[i], result[i + 1]), which may be none
///
/// O(n log(sum of loads)). Greedy runs of a given greatest load, and a search by halves for the smallest with which
/// `blocks` of them are enough.
std::vector<std::int64_t> cut_evenly(std::span<const std::int64_t> loads, int blocks);

}  // namespace pointskin::scale
