// Cuts a surface along an iso-line of values at its vertices, and clears small pieces.
// Source: M. Kazhdan's SurfaceTrimmer (PoissonRecon), which splits polygons at the trimming value and moves connected
// pieces below an area ratio to the other side. Differs: pieces are sorted out before anything is split, so a piece
// that stays leaves no cut in its triangles; triangles stay triangles.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "surface/extract.hpp"

namespace pointskin::surface {

struct TrimOptions {
  float limit = 0;          ///< what has larger values is cut away
  double island_ratio = 0;  ///< connected pieces below this share of the area change sides, in [0, 1)
};

/// What was cut. Areas in unit cube units.
struct TrimCounts {
  double area_before = 0, area_kept = 0;
  std::int64_t triangles_before = 0;
  std::int64_t triangles_removed = 0;  ///< of triangles_before, nothing is left
  std::int64_t triangles_split = 0;    ///< of triangles_before, a part is left
  std::int64_t islands_removed = 0;    ///< kept pieces that were too small
  std::int64_t holes_filled = 0;       ///< pieces to be cut away that were too small
};

/// Keeps the part of `surface` where `values`, linear in every triangle, are at most the limit.
///
/// Small pieces first: those to be cut away are kept, then those kept are cut away; so a speck within a hole that is
/// filled stays. A triangle across the line keeps one or two triangles in its place, along the shorter diagonal.
/// Vertices that stay keep their order; after them come those on the line, by the ids of their edges' ends, smaller
/// end first. They stay kCrossingMargin of an edge away from its ends. From a closed 2-manifold comes a 2-manifold with
/// boundary, oriented alike, without unused vertices; the order of triangles is kept.
/// @param values  shape (v), finite
/// @returns the surface as it came if nothing is cut, one without triangles if nothing is left
/// O(v + t) and a sort of the crossed edges; four to eight host round trips, for sizes and sums. Deterministic: areas
/// of pieces are summed in integers, the same bits on every device.
template <exec::Space Exec>
Surface trim_surface(Exec& ex, Surface surface, ArrayView<const float> values, const TrimOptions& options,
                     TrimCounts& counts);

}  // namespace pointskin::surface
