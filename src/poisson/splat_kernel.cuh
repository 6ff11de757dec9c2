// Splatting normals on a GPU, one warp a brick, with the bits of SplatToBricks.
//
// The samples of the 27 bricks around are one list. 32 lanes look at 32 of them at once and note those in reach, about
// a third; of 32 in reach they stage the weights in shared memory, one each; then 24 lanes, one for each corner and
// axis, add up what is staged, in the list's order. A thread a brick would wait for one sample after another, a thread
// a corner would test every sample eight times.
#pragma once

#include <cstdint>

#include "exec/cuda_primitives.cuh"
#include "poisson/splat_to_bricks.hpp"

namespace pointskin::poisson {

using exec::kWarp;

/// A warp's staged samples: weights on the brick's corners, and what the samples add to V.
struct StagedSamples {
  static constexpr int kStride = kWarp + 4;  // rows start at multiples of 16 bytes, each in other banks
  alignas(16) float weight[8][kStride];
  alignas(16) float vector[3][kStride];

  /// sum + the first `count` products of a corner and an axis, one after another.
  [[nodiscard]] __device__ float add(int corner, int axis, int count, float sum) const {
    const float* w = weight[corner];
    const float* v = vector[axis];
    int i = 0;
    for (; i + 4 <= count; i += 4) {
      const float4 w4 = *reinterpret_cast<const float4*>(w + i);
      const float4 v4 = *reinterpret_cast<const float4*>(v + i);
      sum += w4.x * v4.x;
      sum += w4.y * v4.y;
      sum += w4.z * v4.z;
      sum += w4.w * v4.w;
    }
    for (; i < count; ++i) sum += w[i] * v[i];
    return sum;
  }
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

/// One warp's work on a brick.
class SplatToBrick {
 public:
  struct Shared {
    SampleList list;
    std::int32_t reaching[2 * kWarp];  // samples that reach the brick, in the list's order
    StagedSamples staged;
  };

  __device__ SplatToBrick(const SplatSource& source, std::int64_t brick, int lane, Shared& shared)
      : source_(source),
        shared_(shared),
        lane_(lane),
        origin_(brick_origin(source.level, brick)),
        scale_(static_cast<float>(1 << source.level.depth)) {}

  /// Looks at sample `rank` of the list, if the lane has one.
  __device__ void test(std::int32_t rank, bool exists) {
    std::int32_t sample = 0;
    bool reaches = false;
    if (exists) {
      sample = source_.subset.sample_of(rank);
      reaches = at(sample).reaches_unordered<QuadraticKernel>() && source_.is_splatted(sample);
    }
    const unsigned lanes = __ballot_sync(~0U, reaches);
    if (reaches) shared_.reaching[count_ + __popc(lanes & ((1U << lane_) - 1))] = sample;
    count_ += __popc(lanes);
    __syncwarp();
    if (count_ >= kWarp) add();
  }

  /// Adds the first 32 samples that reach the brick, or all of them.
  __device__ void add() {
    const int adding = count_ < kWarp ? count_ : kWarp;
    if (lane_ < adding) stage(shared_.reaching[lane_]);
    count_ -= adding;
    const std::int32_t next = lane_ < count_ ? shared_.reaching[kWarp + lane_] : 0;
    __syncwarp();
    sum_ = shared_.staged.add(corner(), axis(), adding, sum_);
    if (lane_ < count_) shared_.reaching[lane_] = next;
    __syncwarp();
  }

  [[nodiscard]] __device__ int corner() const { return lane_ & 7; }
  [[nodiscard]] __device__ int axis() const { return lane_ < 24 ? lane_ >> 3 : 2; }
  [[nodiscard]] __device__ float sum() const { return sum_; }

 private:
  [[nodiscard]] __device__ BrickSample at(std::int32_t sample) const {
    return {source_.samples.positions[sample], origin_, scale_};
  }

  __device__ void stage(std::int32_t sample) const {
    float weight[8];
    at(sample).weights<QuadraticKernel>(weight);
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) shared_.staged.weight[s][lane_] = weight[s];
    const Vec3f v = source_.vector(sample);
    shared_.staged.vector[0][lane_] = v.x;
    shared_.staged.vector[1][lane_] = v.y;
    shared_.staged.vector[2][lane_] = v.z;
  }

  const SplatSource& source_;
  Shared& shared_;
  int lane_;
  octree::Coordinates origin_;
  float scale_;
  int count_ = 0;  // of samples in `reaching`
  float sum_ = 0;  // for the lane's corner and axis
};

/// Adds samples to V at the corners of a brick: SplatToBricks, a warp a brick.
struct SplatByWarps {
  SplatSource source;
  VectorField field;

  using Shared = SplatToBrick::Shared;

  __device__ void operator()(std::int64_t brick, int lane, Shared& shared) const {
    const std::int32_t length = list_samples(source, brick, lane, shared.list);
    if (length == 0) return;
    SplatToBrick splat(source, brick, lane, shared);
    for (std::int32_t k = lane; k - lane < length; k += kWarp) {
      const bool exists = k < length;
      splat.test(exists ? shared.list[k] : 0, exists);
    }
    splat.add();
    if (lane < 24) field.axis[splat.axis()][8 * brick + splat.corner()] += splat.sum();
  }
};

inline void splat_to_bricks(exec::Cuda& ex, const SplatSource& source, const VectorField& field) {
  for_each_warp(ex, "splat.normals", source.level.bricks, SplatByWarps{source, field});
}

}  // namespace pointskin::poisson
