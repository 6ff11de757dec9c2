// The isosurface of a field as a closed, 2-manifold mesh, across all levels of the octree (P9).
// Source: Zhou et al. 2010, section 4.4; the transition cells follow Kazhdan, Klein, Dalal & Hoppe, "Unconstrained
// isosurface extraction on arbitrary octrees", SGP 2007, for the one case that 2:1 grading leaves. Differs: coarse
// leaves are not refined to depth D; they close the loops of their finer faces' segments.
#pragma once

#include <cstdint>
#include <functional>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"

namespace pointskin::surface {

/// Morton keys begin..end - 1 of cells of the finest level.
struct KeyRange {
  std::uint64_t begin = 0, end = ~std::uint64_t{0};
  [[nodiscard]] PSK_HD bool holds(std::uint64_t key) const { return key >= begin && key < end; }
};

/// Where the vertices and triangles of a surface come from, for meshes of blocks. Keys are Morton keys in units of the
/// finest cells.
struct SurfacePlaces {
  exec::Buffer<std::uint64_t> keys;   ///< (v) of the corners that vertices start at, ascending
  exec::Buffer<std::uint64_t> cells;  ///< (t) of the cells that triangles lie in
  exec::Buffer<std::uint8_t>
      segments;  ///< (t) ascending: the level of the cell, and kTraced more where it is next to finer ones
  static constexpr int kTraced = 64;
};

struct ExtractOptions {
  float curvature = 1;  ///< crossings by the rescaled quadratic with this share of its curvature; 0: linear
  bool normals = true;  ///< vertex normals from the field's gradient
  /// Called with the vertices on edges, in no order, and the inside ends of their edges, both shape (v) in the space,
  /// before triangles and centres of loops are made; may move the vertices along their edges towards the inside ends.
  std::function<void(ArrayView<Vec3f> vertices, ArrayView<const Vec3f> inside_ends)> move_vertices{};
  SurfacePlaces* places = nullptr;  ///< receives where all comes from, if not null
  KeyRange counted{};               ///< cells at whose corners lone ones are counted
};

/// A mesh in the space it was made in.
struct Surface {
  exec::Buffer<Vec3f> positions;     ///< (v) in the unit cube, sorted by Morton key of the cell corner they start at
  exec::Buffer<Vec3f> normals;       ///< (v) unit length, or (0)
  exec::Buffer<Triangle> triangles;  ///< (t) counter-clockwise from outside, by level and Morton key of their cells;
                                     ///< those of cells next to finer ones last
  /// Corners that none of their six neighbours is on one side with, alone or as a pair: pieces of eight triangles around
  /// one, or of some more around two. A bound from above: diagonals may join them to others.
  std::int64_t lone_corners = 0;
};

/// Extracts the level set of `f` at its isovalue. Every edge of the mesh has exactly two triangles and every vertex one
/// fan, except on the faces of the cube if f.closed is false. An empty mesh if nothing crosses.
/// @throws Error over_limit if nodes, vertices or triangles exceed 2^31
/// O(nodes); a handful of host round trips, for sizes only. Deterministic, the same bits on every device.
template <exec::Space Exec>
Surface extract_surface(Exec& ex, const field::FieldView& f, const ExtractOptions& options);

}  // namespace pointskin::surface
