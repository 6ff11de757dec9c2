// The surface at a distance from another one, as a field of its own: a new octree around it, with the signed distance
// to the other surface's triangles at every corner. Source: Jones, Baerentzen & Sramek, "3D distance fields: a survey
// of techniques and applications", IEEE TVCG 12, 2006; Frisken, Perry, Rockwood & Jones, "Adaptively sampled distance
// fields", SIGGRAPH 2000 (cells where the surface is, found top-down). Differs: the sign is that of the field the surface
// came from (docs/decisions/0020-signed-distance-and-offset.md, 0051-exact-offsets.md).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field {

/// A surface with the field it came from.
struct SurfaceOfField {
  FieldView field;
  octree::Frame frame;  ///< of the field and of the vertices
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
};

struct OffsetField {
  octree::OctreeData tree;
  exec::Buffer<float> values;  ///< minus the signed distance at the corners of all levels, in finest cells
  std::int64_t band_cells = 0;
};

/// Field whose level set -offset_cells is the surface at that distance from `surface`, in the unit cube of `frame`.
///
/// Cells whose distance from the surface may be the offset are found from the complete levels down; an octree is built
/// of those of level `depth`. A corner's distance is that to the nearest triangle, exact up to rounding.
/// Its sign is that of the field at its place; outside of the field's cube is outside.
/// @param surface       closed, with at least one triangle
/// @param depth         D in [1, kMaxDepth]; finest cells are frame.size / 2^D wide
/// @param offset_cells  in finest cells, > 0 outwards
/// @throws Error empty_result if nothing is at that distance, over_limit (2^31 cells, memory)
/// O((t + corners) log t) for t triangles, more where many triangles are about equally far; two round trips a level.
/// Deterministic, the same bits on every device.
template <exec::Space Exec>
OffsetField make_offset(Exec& ex, const SurfaceOfField& surface, const octree::Frame& frame, int depth,
                        double offset_cells);

}  // namespace pointskin::field
