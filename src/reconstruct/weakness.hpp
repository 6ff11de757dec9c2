// Where a reconstruction is doubtful: at points of the surface, from what the fit knows.
// Source: Sharf, Lewiner, Shklarski, Toledo & Cohen-Or, "Interactive topology-aware surface reconstruction", SIGGRAPH
// 2007, section 4 (the topology is weak where the field is flat and samples are far). Differs: the score is measured on
// the surface, against the medians at the samples, instead of at critical points of the field.
#pragma once

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"

namespace pointskin::detail {

/// What is usual at the samples.
struct WeaknessScale {
  float density = 0;   ///< median of the samples per finest cell face
  float gradient = 0;  ///< median length of the field's gradient, per finest cell
};

/// The lower median of the samples per finest cell face, over `points`, of which there is one. A sort; waits.
template <exec::Space Exec>
float median_density(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                     ArrayView<const Vec3f> points);

/// Medians at the samples. Two sorts of n keys; waits.
/// @param values  of the field, at the corners of all levels
template <exec::Space Exec>
WeaknessScale weakness_scale(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                             const float* values, ArrayView<const Vec3f> samples);

/// out[i] = (1 - min(1, density / usual)) (1 - min(1, |gradient| / usual)) at points of the unit cube: 0 where either
/// is what it is at half of the samples or more, 1 where both are 0. O(n depth).
template <exec::Space Exec>
void evaluate_weakness(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density, const float* values,
                       const WeaknessScale& scale, ArrayView<const Vec3f> points, ArrayView<float> out);

}  // namespace pointskin::detail
