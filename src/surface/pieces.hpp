// Leaves out connected pieces of a surface that are small.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "surface/extract.hpp"

namespace pointskin::surface {

struct PieceOptions {
  bool largest = false;  ///< only the piece with the largest area stays; of several, that of the first vertex
  double least = 0;      ///< smaller pieces go: >= 1: in triangles; in (0, 1): in shares of the whole area
  /// Pieces that fewer samples lie on go, but for the largest: the integral of the density over the piece. 0: none.
  double least_samples = 0;
  ArrayView<const float> density{};  ///< samples per area of the cube's unit at the vertices; with least_samples
};

struct PieceCounts {
  std::int64_t pieces = 0;             ///< before
  std::int64_t pieces_removed = 0;     ///< of them
  std::int64_t triangles_removed = 0;  ///< with them
};

/// Leaves out pieces, connected through common vertices. What stays keeps its order; vertices without triangles go.
/// @returns the surface as it came if nothing goes, one without triangles if all does
/// O(v + t); three host round trips more if something goes. 20 bytes a vertex of scratch, and those of trim_surface.
/// Deterministic: areas are summed in integers, the same bits on every device.
template <exec::Space Exec>
Surface keep_pieces(Exec& ex, Surface surface, const PieceOptions& options, PieceCounts& counts);

}  // namespace pointskin::surface
