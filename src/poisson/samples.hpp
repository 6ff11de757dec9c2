// The samples as the solver sees them: sorted by key, in the unit cube, with an area each.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"

namespace pointskin::poisson {

/// Samples in key order; shape (n) each.
struct SamplesView {
  ArrayView<const Vec3f> positions;  ///< in the unit cube
  ArrayView<const Vec3f> normals;    ///< unit length, or zero for a sample without a normal
  ArrayView<const float> areas;  ///< area of the surface that the sample stands for, in finest cells^2; 0 only for zero
                                 ///< normals with confidence
  ArrayView<const std::uint8_t> splat_depths;  ///< depth whose cells hold enough samples to carry the normal
  ArrayView<const float> trust;                ///< factor on the weight in the screening, > 0; empty: 1 everywhere
  int coarsest_splat_depth = 0;                ///< smallest of splat_depths
  std::uint32_t splat_depth_set = ~0U;         ///< bit d: some splat_depths may be d
};

/// Owns what SamplesView shows.
struct Samples {
  exec::Buffer<Vec3f> positions;
  exec::Buffer<Vec3f> normals;
  exec::Buffer<float> areas;
  exec::Buffer<std::uint8_t> splat_depths;
  exec::Buffer<float> trust;
  int coarsest_splat_depth = 0;
  std::uint32_t splat_depth_set = ~0U;

  [[nodiscard]] SamplesView view() const {
    return {positions.cview(), normals.cview(),      areas.cview(),  splat_depths.cview(),
            trust.cview(),     coarsest_splat_depth, splat_depth_set};
  }
};

}  // namespace pointskin::poisson
