// The right-hand side: normals splatted to a vector field, its divergence, and its restriction to all levels.
// Source: Zhou et al. 2010, sections 4.2 and appendix (equations 2, 4, 5). Differs: corner hats, so coarse levels are
// the restriction of the finer one; samples are splatted at the depths that their density supports.
#pragma once

#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/resolution.hpp"
#include "poisson/samples.hpp"

namespace pointskin::poisson {

/// Divergence of the samples' vector field, tested with every hat of every level:
///   b_i = integral V . grad phi_i / h,   V = - sum_p a_p n_p B(x - p),   B the quadratic B-spline of the splat depth,
/// or those of the two levels around it with its shares.
/// Cells that are missing at a level do not contribute, so the sum over all corners of a level is zero.
/// @param resolution  the cells that count: V is integrated on those without children that count
/// @returns shape (nodes of all levels), level-major
/// O(27 n + 81 nodes), no atomics, deterministic.
template <exec::Space Exec>
exec::Buffer<float> splat_divergence(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples,
                                     const Resolution& resolution);

}  // namespace pointskin::poisson
