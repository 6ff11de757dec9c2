// What all points of a cloud decide together before they are sorted, for clouds that memory does not hold.
#pragma once

#include <cstdint>

#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "octree/strays.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

struct CloudExtent {
  std::int64_t points = 0;       ///< without strays
  std::int64_t dropped = 0;      ///< rows without finite coordinates
  std::int64_t with_normal = 0;  ///< of them, that have a normal that is not zero
  octree::StrayPoints strays;    ///< indices count the points of the file; the core is the box around all others
  std::int64_t before = 0;       ///< points, strays among them, in the rows before those that this rank reads
};

/// The strays and the box of all other points, as octree::find_strays() finds them: one pass over the points, and one
/// more where some lie so far out that there may be strays. 100 KB, and 20 bytes for every point that may be one, which
/// are few. Each rank reads its share of the rows. Collective.
/// @param parts        whose origin has been chosen
/// @param keep_strays  all points count
/// @throws Error empty_result if there are no points; as CloudParts::read
CloudExtent find_extent(exec::Cpu& ex, const io::CloudParts& parts, bool keep_strays, const Team& team = {});

/// The points outside of a cube, as octree::find_outside() finds them: one pass over the points. Collective.
/// @param before  as CloudExtent has it
/// @throws Error as CloudParts::read
octree::StrayPoints find_outside(exec::Cpu& ex, const io::CloudParts& parts, const octree::Frame& cube,
                                 const Bounds& core, const Team& team = {}, std::int64_t before = 0);

}  // namespace pointskin::scale
