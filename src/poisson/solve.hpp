// The screened Poisson solve: from coarse to fine, a few Chebyshev iterations on every level.
// Source: Zhou et al. 2010, section 4.3; Kazhdan & Hoppe 2013; Saad, "Iterative methods for sparse linear systems", 2nd
// ed., algorithm 12.1 (Chebyshev acceleration). Differs: Chebyshev instead of conjugate gradients, so no dot products
// (docs/decisions/0003-chebyshev.md).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "poisson/previous.hpp"
#include "poisson/samples.hpp"
#include "poisson/screening.hpp"

namespace pointskin::poisson {

struct SolveOptions {
  double screening = 2;                     ///< weight w of the point constraints, >= 0
  int iterations = 8;                       ///< Chebyshev iterations on every level finer than the complete ones, >= 1
  bool residuals = false;                   ///< measure the residual of every level before and after
  std::function<void(int)> before_level{};  ///< called on the host with every depth about to be solved; may throw
  ArrayView<const std::uint8_t> free_unknowns{};  ///< (bricks of all levels) unknowns to solve for, from
                                                  ///< poisson/boundary.hpp; others stay 0; empty: all
  PreviousField previous{};                       ///< a field to start from, if it has values
};

struct LevelSolve {
  int depth = 0;
  std::int64_t unknowns = 0;
  int iterations = 0;
  double residual_before = 0, residual_after = 0;  ///< 2-norm of b - A u over the unknowns, in units of h
};

struct Solution {
  exec::Buffer<float> u;  ///< over the nodes of all levels, level-major: the field at the corners of every level
  std::vector<LevelSolve> levels;
};

/// Minimises  integral |grad u - V|^2 + w 2^d sum_p a_p (u(p) - 1/2)^2  level by level, d = 0..D: u_d starts as the
/// interpolation of u_(d-1), or as poisson/previous.hpp has it; corners that are not unknowns of their level keep that
/// value; unknowns that are not free are 0.
/// @param tree  with the unknowns of the cells that count (Resolution::view)
/// @param b     shape (nodes of all levels), from splat_divergence
/// O(iterations (27 nodes + 64 occupied cells)); one launch an iteration, no round trips unless residuals are asked
/// for. Deterministic, the same bits on every device.
template <exec::Space Exec>
Solution solve_poisson(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b, const Screening& screening,
                       const SolveOptions& options);

/// Mean of u over the samples whose area is not 0: the isovalue. O(n depth), in double.
template <exec::Space Exec>
double mean_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u, const SamplesView& samples);

}  // namespace pointskin::poisson
