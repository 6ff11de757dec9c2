// Splatting normals on a GPU, one warp a brick, with the bits of SplatToBricks.
//
// The samples of the 27 bricks around are one list. 32 lanes look at 32 of them at once and stage those in reach in
// shared memory, in the list's order; then 24 lanes, one for each corner and axis, add up what is staged. A thread a
// brick would wait for one sample after another, a thread a corner would test every sample eight times.
#pragma once

#include <cstdint>

#include "exec/cuda_primitives.cuh"
#include "poisson/divergence_impl.hpp"

namespace pointskin::poisson::divergence {

inline constexpr int kWarp = 32;
inline constexpr int kSplatWarps = 4;  // per block

/// A warp's staged samples: weights along the axes on lower and upper corners, and what the samples add to V.
struct StagedSamples {
  static constexpr int kCapacity = 2 * kWarp + 1;  // odd: rows start in different banks
  float weight[3][2][kCapacity];
  float vector[3][kCapacity];
};

/// The list of the samples around a brick.
struct SampleList {
  std::int32_t before[kWarp];  // samples in the bricks before brick j
  std::int32_t first[kWarp];   // rank of the first sample of brick j

  /// Rank of sample k of the list.
  [[nodiscard]] __device__ std::int32_t operator[](std::int32_t k) const {
    int j = 0;
    for (int step = kWarp / 2; step > 0; step /= 2)
      if (before[j + step] <= k) j += step;
    return first[j] + (k - before[j]);
  }
};

/// Fills the list and returns its length. All lanes of a warp call it.
__device__ inline std::int32_t list_samples(const SplatSource& source, std::int64_t brick, int lane, SampleList& list) {
  std::int32_t first = 0;
  std::int32_t count = 0;
  if (lane < octree::kNeighbours) {
    const octree::LevelView& level = source.level;
    const std::int32_t other = level.neighbours[brick * octree::kNeighbours + lane];
    if (other >= 0 && other < level.cell_bricks) {
      first = source.subset.rank_of(level.point_begin[8 * std::int64_t{other}]);
      count = source.subset.rank_of(level.point_begin[8 * std::int64_t{other} + 8]) - first;
    }
  }
  std::int32_t sum = count;
  for (int step = 1; step < kWarp; step *= 2) {
    const std::int32_t lower = __shfl_up_sync(~0U, sum, step);
    if (lane >= step) sum += lower;
  }
  list.before[lane] = sum - count;
  list.first[lane] = first;
  __syncwarp();
  return __shfl_sync(~0U, sum, kWarp - 1);
}

/// Stages the sample if it reaches the brick. All lanes of a warp call it. @returns the number staged then
__device__ inline int stage(const SplatSource& source, std::int32_t rank, bool exists,
                            const octree::Coordinates& origin, float scale, int lane, int staged, StagedSamples& out) {
  std::int32_t sample = 0;
  BrickSample at({}, origin, scale);
  bool reaches = false;
  if (exists) {
    sample = source.subset.sample_of(rank);
    at = BrickSample(source.samples.positions[sample], origin, scale);
    reaches = at.reaches<QuadraticKernel>() && source.is_splatted(sample);
  }
  const unsigned lanes = __ballot_sync(~0U, reaches);
  if (reaches) {
    const int place = staged + __popc(lanes & ((1U << lane) - 1));
    float weight[3][2];
    at.weights_by_axis<QuadraticKernel>(weight);
    PSK_UNROLL for (int a = 0; a < 3; ++a) PSK_UNROLL for (int side = 0; side < 2; ++side) out.weight[a][side][place] =
        weight[a][side];
    const Vec3f v = source.vector(sample);
    out.vector[0][place] = v.x;
    out.vector[1][place] = v.y;
    out.vector[2][place] = v.z;
  }
  __syncwarp();
  return staged + __popc(lanes);
}

__global__ void __launch_bounds__(kSplatWarps* kWarp) splat_bricks_kernel(const SplatSource source, VectorField field) {
  __shared__ StagedSamples all_staged[kSplatWarps];
  __shared__ SampleList all_lists[kSplatWarps];
  const int warp = static_cast<int>(threadIdx.x) / kWarp;
  const int lane = static_cast<int>(threadIdx.x) % kWarp;
  const std::int64_t brick = std::int64_t{blockIdx.x} * kSplatWarps + warp;
  if (brick >= source.level.bricks) return;
  StagedSamples& staged = all_staged[warp];
  SampleList& list = all_lists[warp];
  const std::int32_t length = list_samples(source, brick, lane, list);
  if (length == 0) return;

  const octree::Coordinates origin = brick_origin(source.level, brick);
  const auto scale = static_cast<float>(1 << source.level.depth);
  const int corner = lane & 7;
  const int axis = lane < 24 ? lane >> 3 : 2;
  float sum = 0;
  int count = 0;
  const auto add_staged = [&] {
    const float* x = staged.weight[0][octree::slot_x(corner)];
    const float* y = staged.weight[1][octree::slot_y(corner)];
    const float* z = staged.weight[2][octree::slot_z(corner)];
    for (int i = 0; i < count; ++i) sum += x[i] * y[i] * z[i] * staged.vector[axis][i];
    count = 0;
    __syncwarp();
  };
  for (std::int32_t k = 0; k < length; k += kWarp) {
    const bool exists = k + lane < length;
    count = stage(source, exists ? list[k + lane] : 0, exists, origin, scale, lane, count, staged);
    if (count >= kWarp) add_staged();
  }
  add_staged();
  if (lane < 24) field.axis[axis][8 * brick + corner] += sum;
}

inline void splat_to_bricks(exec::Cuda& ex, const SplatSource& source, const VectorField& field) {
  const std::int64_t blocks = (std::int64_t{source.level.bricks} + kSplatWarps - 1) / kSplatWarps;
  splat_bricks_kernel<<<static_cast<unsigned>(blocks), kSplatWarps * kWarp, 0, exec::stream_of(ex)>>>(source, field);
  exec::cuda_check(cudaGetLastError(), "splat.normals");
}

}  // namespace pointskin::poisson::divergence
