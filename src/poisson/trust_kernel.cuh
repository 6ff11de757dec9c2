// Trust on a GPU, a warp a cell, with the bits of TrustInCell.
#pragma once

#include <cstdint>

#include "exec/cuda_primitives.cuh"
#include "poisson/trust_in_cells.hpp"

namespace pointskin::poisson {

using exec::kWarp;
inline constexpr int kCellsPerWarp = kWarp / kLanes;

/// A warp's work on kCellsPerWarp cells.
struct TrustByLanes {
  static constexpr int kAtOnce = 4;

  TrustInCells cells;

  struct Shared {};

  __device__ void operator()(std::int64_t item, int lane, Shared&) const {
    const std::int64_t cell = kCellsPerWarp * item + lane / kLanes;
    const bool exists = cell < cells.level.cells();
    const std::int32_t first = exists ? cells.level.point_begin[cell] : 0;
    const std::int32_t end = exists ? cells.level.point_begin[cell + 1] : 0;
    const int own = lane % kLanes;
    Scatter scatter;
    bool any = false;
    const std::int32_t count = end - first;
    for (std::int32_t from = own; from < count; from += kAtOnce * kLanes) {
      // All that is read is asked for before any of it is waited for; what is beyond the end adds nothing.
      PSK_UNROLL
      for (int k = 0; k < kAtOnce; ++k) {
        const std::int32_t i = from + k * kLanes;
        any = (cells.is_meant(first + (i < count ? i : count - 1)) && i < count) || any;
      }
      if (count < 2) continue;
      Scatter part[kAtOnce];
      PSK_UNROLL
      for (int k = 0; k < kAtOnce; ++k) {
        const std::int32_t i = from + k * kLanes;
        const Scatter pair = cells.scatter_of(first + (i < count - 2 ? i : count - 2));
        part[k] = i < count - 1 ? pair : Scatter{};
      }
      PSK_UNROLL
      for (int k = 0; k < kAtOnce; ++k) scatter.add(part[k]);
    }
    if (__ballot_sync(~0U, any) == 0) return;
    for (int step = kLanes / 2; step > 0; step /= 2)
      scatter.add({__shfl_xor_sync(~0U, scatter.sum, step), __shfl_xor_sync(~0U, scatter.pairs, step)});
    for (std::int32_t i = first + own; i < end; i += kLanes)
      if (cells.is_meant(i)) cells.trust[i] = cells.trust_in(i, scatter);
  }
};

inline void find_trust(exec::Cuda& ex, const TrustInCells& cells) {
  for_each_warp(ex, "screening.trust", (cells.level.cells() + kCellsPerWarp - 1) / kCellsPerWarp, TrustByLanes{cells});
}

}  // namespace pointskin::poisson
