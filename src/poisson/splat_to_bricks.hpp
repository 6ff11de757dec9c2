// Splatting normals onto the corners of bricks.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "poisson/samples.hpp"
#include "poisson/splat_kernel.hpp"

namespace pointskin::poisson {

/// Samples splatted at one level: positions among all samples (`rank`) and the samples themselves (`chosen`). Where
/// most samples are wanted both are empty, and others are passed over.
struct Subset {
  ArrayView<const std::int32_t> rank;    // (n + 1) chosen samples before a sample
  ArrayView<const std::int32_t> chosen;  // sample of each rank

  [[nodiscard]] PSK_HD bool is_list() const { return !rank.empty(); }
  [[nodiscard]] PSK_HD std::int32_t rank_of(std::int32_t sample) const { return is_list() ? rank[sample] : sample; }
  [[nodiscard]] PSK_HD std::int32_t sample_of(std::int32_t rank_in_list) const {
    return is_list() ? chosen[rank_in_list] : rank_in_list;
  }
};

/// V at the corners of a level in units of 1 / h, one array an axis.
struct VectorField {
  ArrayView<float> axis[3];
};

/// Samples to be splatted at one level.
struct SplatSource {
  octree::LevelView level;
  SamplesView samples;
  Subset subset;
  float area_scale;  // finest cells^2 -> cells^2 of this level

  [[nodiscard]] PSK_HD bool is_splatted(std::int32_t sample) const {
    return subset.is_list() || splat_share(samples.splat_depths[sample], level.depth) > 0;
  }

  /// What the sample adds to V of the level: -area n.
  [[nodiscard]] PSK_HD Vec3f vector(std::int32_t sample) const {
    const Vec3f n = samples.normals[sample];
    const float area = samples.areas[sample] * (area_scale * splat_share(samples.splat_depths[sample], level.depth));
    return {-area * n.x, -area * n.y, -area * n.z};
  }
};

/// Adds samples to V at the corners of a brick. A GPU has a kernel of its own for it (splat_kernel.cuh).
struct SplatToBricks {
  SplatSource source;
  VectorField field;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(source.level, brick);
    const auto scale = static_cast<float>(1 << source.level.depth);
    float sum[3][8] = {};
    bool any = false;
    for_points_around(source.level, brick, [&](std::int32_t first, std::int32_t last) {
      const std::int32_t end = source.subset.rank_of(last);
      for (std::int32_t rank = source.subset.rank_of(first); rank < end; ++rank) {
        add(source.subset.sample_of(rank), origin, scale, sum);
        any = true;
      }
    });
    if (!any) return;
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < 8; ++s) field.axis[a][8 * brick + s] += sum[a][s];
  }

  PSK_HD void add(std::int32_t sample, const octree::Coordinates& origin, float scale, float (&sum)[3][8]) const {
    if (!source.is_splatted(sample)) return;
    const BrickSample at(source.samples.positions[sample], origin, scale);
    if (!at.reaches<QuadraticKernel>()) return;
    float w[8];
    at.weights<QuadraticKernel>(w);
    const Vec3f v = source.vector(sample);
    for (int s = 0; s < 8; ++s) sum[0][s] += w[s] * v.x;
    for (int s = 0; s < 8; ++s) sum[1][s] += w[s] * v.y;
    for (int s = 0; s < 8; ++s) sum[2][s] += w[s] * v.z;
  }

#if PSK_WIDE
  static constexpr int kBatch = 64;  ///< samples that are tested before those that reach the brick are added

  /// Sums over the samples so far, a lane for each corner.
  struct Sums {
    Float8 axis[3] = {};
    bool any = false;
  };

  PSK_INLINE void wide(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(source.level, brick);
    Sums sums;
    for_points_around(source.level, brick, [&](std::int32_t first, std::int32_t last) {
      const std::int32_t end = source.subset.rank_of(last);
      for (std::int32_t rank = source.subset.rank_of(first); rank < end; rank += kBatch)
        add_batch(rank, rank + kBatch < end ? rank + kBatch : end, origin, sums);
    });
    if (!sums.any) return;
    PSK_UNROLL
    for (int a = 0; a < 3; ++a) {
      float* v = &field.axis[a][8 * brick];
      store8(load8(v) + sums.axis[a], v);
    }
  }

  /// Samples of ranks [first, last), at most kBatch: those that reach the brick are listed before they are added.
  PSK_INLINE void add_batch(std::int32_t first, std::int32_t last, const octree::Coordinates& origin,
                            Sums& sums) const {
    const auto scale = static_cast<float>(1 << source.level.depth);
    std::int32_t reaching[kBatch];
    int count = 0;
    for (std::int32_t rank = first; rank < last; ++rank) {
      const std::int32_t sample = source.subset.sample_of(rank);
      const BrickSample at(source.samples.positions[sample], origin, scale);
      reaching[count] = sample;
      count += at.reaches_unordered<QuadraticKernel>() ? 1 : 0;
    }
    for (int i = 0; i < count; ++i) {
      if (!source.is_splatted(reaching[i])) continue;
      Float8 w;
      BrickSample(source.samples.positions[reaching[i]], origin, scale).weights<QuadraticKernel>(w);
      const Vec3f v = source.vector(reaching[i]);
      sums.axis[0] += w * v.x;
      sums.axis[1] += w * v.y;
      sums.axis[2] += w * v.z;
      sums.any = true;
    }
  }
#endif
};

}  // namespace pointskin::poisson
