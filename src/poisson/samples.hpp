// The samples as the solver sees them: sorted by key, in the unit cube, with an area each.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"

namespace pointskin::poisson {

/// The level of a whole splat depth, else the finer of the two around it.
PSK_HD inline int finer_level(float splat_depth) {
  const int coarser = static_cast<int>(splat_depth);
  return splat_depth > static_cast<float>(coarser) ? coarser + 1 : coarser;
}

/// Share of a sample's normal that is splatted at level `depth`; between two levels both get some.
PSK_HD inline float splat_share(float splat_depth, int depth) {
  const float off = splat_depth - static_cast<float>(depth);
  const float distance = off < 0 ? -off : off;
  return distance < 1 ? 1 - distance : 0;
}

/// Share of a cell's face at level `depth` that a sample can speak for: 1 up to its splat depth, then a fourth with
/// every level, in between linear.
PSK_HD inline float sampled_share(float splat_depth, int depth) {
  const int finer = finer_level(splat_depth);
  if (depth < finer) return 1;
  const float at_finer = 1 - 0.75F * (static_cast<float>(finer) - splat_depth);
  return at_finer / static_cast<float>(std::int64_t{1} << 2 * (depth - finer));
}

/// Samples in key order; shape (n) each.
struct SamplesView {
  ArrayView<const Vec3f> positions;  ///< in the unit cube
  ArrayView<const Vec3f> normals;    ///< unit length, or zero for a sample without a normal
  ArrayView<const float> areas;  ///< area of the surface that the sample stands for, in finest cells^2; 0 for outliers,
                                 ///< and with confidence for zero normals
  ArrayView<const float> splat_depths;    ///< depth whose cells hold enough samples to carry the normal, between two
                                          ///< levels where the one is too fine and the other too coarse
  ArrayView<const float> trust;           ///< factor on the weight in the screening, > 0; empty: 1 everywhere
  int coarsest_splat_depth = 0;           ///< coarsest level that normals are splatted at
  std::uint32_t splat_depth_set = ~0U;    ///< bit d: some normals may be splatted at level d
  const std::uint64_t* lonely = nullptr;  ///< one element: how many are far from all others (examine.hpp); or null
};

/// Owns what SamplesView shows.
struct Samples {
  exec::Buffer<Vec3f> positions;
  exec::Buffer<Vec3f> normals;
  exec::Buffer<float> areas;
  exec::Buffer<float> splat_depths;
  exec::Buffer<float> trust;
  exec::Buffer<std::uint64_t> lonely;
  int coarsest_splat_depth = 0;
  std::uint32_t splat_depth_set = ~0U;

  [[nodiscard]] SamplesView view() const {
    return {positions.cview(), normals.cview(),      areas.cview(),   splat_depths.cview(),
            trust.cview(),     coarsest_splat_depth, splat_depth_set, lonely.data()};
  }
};

}  // namespace pointskin::poisson
