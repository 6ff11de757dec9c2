// Where a trim would cut: densities below which the surface goes.
#pragma once

#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin::studio {

/// Densities of the surface at its samples, the sparsest first: of every point that a vertex is near, that of the nearest
/// one, for at most 50,000 points, evenly chosen by their order.
/// @param density  shape (v), of the vertices of `mesh`, samples per area
/// O(v log v + samples log v). Deterministic.
std::vector<float> densities_at_samples(const Mesh& mesh, const std::vector<float>& density, const Cloud& cloud);

/// Below this density a trim cuts: samples lie 1.75 times farther apart than at the sparsest `share` of the samples.
/// @param at_samples  as above, not empty. @param share  in [0, 1)
double trim_threshold(const std::vector<float>& at_samples, double share);

}  // namespace pointskin::studio
