// Signs of normals from what the input says of single points, some of it wrong: evidence averaged over neighbours.
// docs/algorithm.md, section 19; docs/decisions/0027-signs.md.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "normals/link_votes.hpp"

namespace pointskin::normals {

/// The likelier signs of single points.
struct LikelySigns {
  exec::Buffer<std::int32_t> signs;  ///< (n) 1 or -1; empty: the input says nothing of single points
  double typical = 0;                ///< mean vote of all links, of kFullVote; infinite: signs are those of the input,
                                     ///< which tells sheets apart that links do not
};

/// What is known of single points, averaged over links for a few rounds. How much a point's own evidence weighs beside
/// its neighbours' follows from how often links contradict it, and each other.
/// @param evidence  (n) 1, -1 or 0: which sign the input speaks for
/// About 6 passes over the links. Up to 40 % of wrong signs; with more, neighbours say as much as chance.
template <exec::Space Exec>
LikelySigns spread_evidence(Exec& ex, const LinkedLines& lines, ArrayView<const std::int32_t> evidence);

}  // namespace pointskin::normals
