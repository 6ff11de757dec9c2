// Pieces that no samples ask for: outliers that others confirm by chance leave bubbles of a few triangles, and so does noise.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <cstdint>

#include "diagnose/verdict.hpp"
#include "reconstruct/fit_field.hpp"

namespace pointskin::detail {

/// Pieces on which fewer samples lie go where some are lonely: outliers come alone or a few together, and a piece of a
/// scan with so few samples has no shape yet.
inline constexpr double kFewestSamples = 24;

/// Elsewhere pieces with fewer go: so many points are the corners of a solid.
inline constexpr double kFewestOfSolid = 4;

/// True if a surface of the field may lose pieces without samples, for which its density is needed. Where a user says which
/// pieces stay, that holds.
inline bool picks_pieces_by_support(bool largest, double min_component) { return !largest && min_component == 0; }
inline bool picks_pieces_by_support(const FieldData& field, const Options& options) {
  return picks_pieces_by_support(options.largest, options.min_component) && !field.density.counts.empty();
}

/// How many samples a piece needs to stay; 0: none.
/// @param lone_corners  surface::Surface::lone_corners: pieces are only looked at where there may be small ones
inline double fewest_samples(bool has_outliers, std::int64_t lone_corners) {
  if (has_outliers) return kFewestSamples;
  return lone_corners > 0 ? kFewestOfSolid : 0;
}
inline double fewest_samples(const FieldData& field, std::int64_t lone_corners) {
  return fewest_samples(field.drops_specks || diagnose::findings_of(field.seen).lonely > 0, lone_corners);
}

}  // namespace pointskin::detail
