// Relative signs of normals: a graph of neighbours whose links vote for equal or opposite signs, merged from the surest
// votes to the least sure.
// Sources: Hoppe et al. 1992, section 3.2 (propagation along a spanning tree); Schertler, Savchynskyy & Gumhold,
// "Towards globally optimal normal orientations for large point clouds", CGF 36, 2017 (signed graphs over patches);
// Boruvka, 1926. Differs: votes between two patches are summed before the next round, so that no single link decides;
// all sums are integers (docs/decisions/0027-signs.md).
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "normals/link_votes.hpp"

namespace pointskin::normals {

/// Points in patches: within one, signs are relative to each other.
struct SignPatches {
  std::int32_t count = 0;
  exec::Buffer<std::int32_t> labels;  ///< (n) in [0, count), by the smallest point of each
  exec::Buffer<std::int32_t> signs;   ///< (n) 1 or -1: times the normals, equal signs within a patch
  exec::Buffer<std::uint64_t> sizes;  ///< (count) points
  exec::Buffer<std::uint64_t> pairs;  ///< (m) lower label << 32 | higher label of linked patches, ascending
  exec::Buffer<PatchVotes> votes;     ///< (m)
};

/// Which patches may become one.
struct MergeRule {
  double agreement = 0;    ///< least |net| / gross, in [0, 1]
  std::int64_t small = 0;  ///< patches of fewer points merge whatever the agreement
  double typical = 0;      ///< unless 0, normals have their likely signs, and links this vote in the mean: only long
                           ///< borders whose links agree and are as good as others turn a large patch over; above 1
                           ///< none does
};

/// Every point a patch of its own, merged along its surest link.
/// @param has_sides  normals have their likely signs: links that turn one of their ends over are left out
/// @throws Error over_limit beyond 2^31 / kNeighbours points
template <exec::Space Exec>
SignPatches start_patches(Exec& ex, const LinkedLines& lines, bool has_sides = false);

/// Boruvka's rounds: every patch takes the best of its allowed pairs, with the largest |net| |net| / gross, until none
/// is left. About log n rounds of a sort of the pairs that are left. Deterministic.
template <exec::Space Exec>
void merge_patches(Exec& ex, const MergeRule& rule, SignPatches& patches);

/// share[i]: votes of the links of point i that agree with `signs`, of all its votes, in [0, 1]; 1/2 if it has none.
template <exec::Space Exec>
void measure_agreement(Exec& ex, const LinkedLines& lines, ArrayView<const std::int32_t> signs, ArrayView<float> share);

}  // namespace pointskin::normals
