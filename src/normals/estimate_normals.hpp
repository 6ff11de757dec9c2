// Lines of normals and curvatures from the points alone.
// Sources: Hoppe et al. 1992, section 3.1 (planes by principal components); Cazals & Pouget, "Estimating differential
// quantities using polynomial fitting of osculating jets", CAGD 22, 2005 (quadrics in the tangent frame); Mitra &
// Nguyen, "Estimating surface normals in noisy point cloud data", SoCG 2003 (the neighbourhood that balances noise and
// curvature). Differs: weights are Tukey's, from the median residual; the neighbourhood grows by whole factors of two
// as long as the scatter does not grow with it (docs/decisions/0026-normals.md).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/search.hpp"

namespace pointskin::normals {

/// Of n points, in the order of the tree; shape (n) each.
struct NormalLines {
  exec::Buffer<Vec3f> normals;    ///< unit length; of the two signs that with the largest component positive
  exec::Buffer<float> flatness;   ///< 1 - smallest / middle eigenvalue, in [0, 1]: how much of a plane the points are
  exec::Buffer<float> curvature;  ///< mean curvature for this sign, > 0 where the surface bends away from the normal,
                                  ///< per side of the cube
  exec::Buffer<float> noise;      ///< scatter of the positions across the surface, in the unit cube; 0 where what
                                  ///< scatters is shape, or another sheet
};

/// Most points of a neighbourhood.
inline constexpr int kMostNeighbours = 64;

/// Fits a plane and, where that is better, a quadric to the nearest points of every point: 16 of them, or 32 or 64
/// where noise dominates.
/// @param points      positions in key order
/// @param neighbours  of find_neighbours
/// O(n) fits of 16, and a search for 64 where points scatter. Deterministic; double, with + - * / and roots alone.
template <exec::Space Exec>
NormalLines estimate_lines(Exec& ex, const octree::SearchView& points, ArrayView<const std::int32_t> neighbours);

}  // namespace pointskin::normals
