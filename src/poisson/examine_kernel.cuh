// A look at the samples on a GPU, with the bits of Examine. A warp takes 32 samples, which are neighbours of each other in key order,
// and stages them in shared memory once, instead of each thread fetching the 17 around its own. Samples of which neighbours of
// neighbours decide, few and often beside each other, are listed for a second pass, a warp a sample: a thread alone would take 17
// times as long, and the others of its warp would wait.
#pragma once

#include <algorithm>
#include <cstdint>

#include "exec/algorithms.hpp"
#include "exec/atomic.hpp"
#include "exec/cuda_primitives.cuh"
#include "poisson/examine_sample.hpp"

namespace pointskin::poisson {

/// The neighbour of a sample that a lane looks at.
struct NeighbourOfLane {
  static constexpr int kPlaces = 2 * static_cast<int>(kWindow) + 1;
  static_assert(kPlaces <= exec::kWarp);

  std::int64_t index;
  bool exists = false;
  Vec3f normal, step;

  __device__ NeighbourOfLane(const Around& around, std::int64_t i, int lane) : index(i - kWindow + lane) {
    if (lane >= kPlaces || index == i || index < 0 || index >= around.positions.size) return;
    const float near = around.reach(i);
    normal = around.normals[index];
    step = around.positions[index] - around.positions[i];
    exists = squared_length(step) < near * near;
  }
};

/// Number of lanes.
__device__ inline int count_lanes(bool is_one) { return __popc(__ballot_sync(~0U, is_one)); }

/// Around::is_confirmed, by all lanes of a warp.
__device__ inline bool is_confirmed_by_warp(const Around& around, std::int64_t i, int lane) {
  const Vec3f own = around.normals[i];
  const NeighbourOfLane other(around, i, lane);
  const bool is_asked = other.exists && Around::is_asked(own, other.normal);
  const int asked = count_lanes(is_asked);
  const int confirming = count_lanes(is_asked && Around::does_confirm(own, other.normal, other.step));
  if (!Around::Confirming{asked, confirming}.are_enough()) return false;
  const int confirmed = count_lanes(is_asked && around.do_neighbours_confirm(other.index));
  return Around::Confirming{asked, confirmed}.are_enough_confirmed();
}

/// Around::is_among_such, by all lanes of a warp.
__device__ inline bool is_among_such_by_warp(const Around& around, std::int64_t i, int lane) {
  const NeighbourOfLane other(around, i, lane);
  return count_lanes(other.exists && around.is_such(around.normals[i], other.index, other.normal)) >= kFewestSuch;
}

/// Samples that are left for the second pass, in any order.
struct LeftSamples {
  ArrayView<std::int32_t> indices;
  std::uint32_t* count;
};

/// The first pass.
struct ExamineByWarps {
  Examine examine;
  LeftSamples left;

  /// A warp's samples and those kWindow before and after them.
  struct Shared {
    static constexpr int kCount = exec::kWarp + 2 * static_cast<int>(kWindow);
    Vec3f positions[kCount], normals[kCount];
  };

  __device__ void operator()(std::int64_t warp, int lane, Shared& shared) const {
    const Around& around = examine.around;
    const std::int64_t n = around.positions.size;
    const std::int64_t begin = exec::kWarp * warp - kWindow;  // of what is staged
    for (int k = lane; k < Shared::kCount; k += exec::kWarp) {
      const std::int64_t j = begin + k;
      if (j < 0 || j >= n) continue;
      shared.positions[k] = around.positions[j];
      shared.normals[k] = around.normals[j];
    }
    __syncwarp();
    const std::int64_t i = exec::kWarp * warp + lane;
    if (i >= n) return;
    const Cloudwide cloud = examine.found[0];
    const Examine::Evidence evidence = examine.look_around(
        i, {{shared.positions - begin, n}, {shared.normals - begin, n}, around.splat_depths}, cloud);
    examine.count_if_lonely(evidence, cloud);
    if (!evidence.is_usual || examine.asks_for_such(i, evidence, cloud))
      left.indices[exec::fetch_add(left.count, 1)] = static_cast<std::int32_t>(i);
    else
      examine.finish(i, evidence, cloud, true, true);
  }
};

/// The second pass: its warps share what is left.
struct ExamineLeft {
  static constexpr std::int64_t kWarps = 4096;

  Examine examine;
  LeftSamples left;

  struct Shared {};

  __device__ void operator()(std::int64_t warp, int lane, Shared&) const {
    const Around& around = examine.around;
    const Cloudwide cloud = examine.found[0];
    const auto count = static_cast<std::int64_t>(*left.count);
    for (std::int64_t k = warp; k < count; k += kWarps) {
      const std::int64_t i = left.indices[k];
      const Examine::Evidence evidence = examine.look_around(i, around, cloud);
      const bool is_confirmed = evidence.is_usual || is_confirmed_by_warp(around, i, lane);
      const bool is_among_such = !examine.asks_for_such(i, evidence, cloud) || is_among_such_by_warp(around, i, lane);
      __syncwarp();  // all have read what one writes
      if (lane == 0) examine.finish(i, evidence, cloud, is_confirmed, is_among_such);
    }
  }
};

inline void examine_each(exec::Cuda& ex, const char* label, std::int64_t n, const Examine& examine) {
  auto indices = exec::make_buffer<std::int32_t>(ex, n);
  auto count = exec::make_buffer<std::uint32_t>(ex, 1);
  exec::fill(ex, count.view(), 0U);
  const LeftSamples left{indices.view(), count.data()};
  for_each_warp(ex, label, (n + exec::kWarp - 1) / exec::kWarp, ExamineByWarps{examine, left});
  for_each_warp(ex, label, std::min(n, ExamineLeft::kWarps), ExamineLeft{examine, left});
}

}  // namespace pointskin::poisson
