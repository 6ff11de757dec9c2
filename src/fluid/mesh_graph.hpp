// Closed meshes in a space: who is next to whom, smoothing, normals, and small components.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "surface/extract.hpp"

namespace pointskin::fluid {

/// The corners of triangles by their vertex. Corner c is corner c % 3 of triangle c / 3.
struct Fans {
  exec::Buffer<std::int32_t> begin;    ///< (vertices + 1) first corner of each vertex
  exec::Buffer<std::int32_t> corners;  ///< (3 triangles) ascending for each vertex
};

/// O(triangles), 36 bytes a triangle of scratch, one sort. @throws Error over_limit beyond 2^31 corners
template <exec::Space Exec>
Fans find_fans(Exec& ex, ArrayView<const Triangle> triangles, std::int64_t vertices);

/// `iterations` times p_v <- p_v + w_v (mean of the vertices next to v - p_v), all at once. The mean is taken in the
/// order of the triangles.
/// Source: Loeschner, Boettcher, Jeske & Bender, "Weighted Laplacian smoothing for surface reconstruction of
/// particle-based fluids", VMV 2023.
/// @param weights  (vertices) in [0, 1]; empty: all 1
template <exec::Space Exec>
void smooth(Exec& ex, const Fans& fans, ArrayView<const Triangle> triangles, ArrayView<const float> weights,
            int iterations, exec::Buffer<Vec3f>& positions);

/// Unit normals at vertices, means of the triangles around weighted by their areas; z where these cancel.
template <exec::Space Exec>
exec::Buffer<Vec3f> normals_of(Exec& ex, const Fans& fans, ArrayView<const Triangle> triangles,
                               ArrayView<const Vec3f> positions);

/// Removes the components of a closed mesh that enclose less than `least_cells` finest cells, inside out or not.
/// Volumes are those of surface::SixVolumes.
/// @param depth  the cells are 2^-depth wide
/// @returns how many. Three host round trips
template <exec::Space Exec>
std::int64_t remove_small_components(Exec& ex, int depth, double least_cells, surface::Surface& mesh);

}  // namespace pointskin::fluid
