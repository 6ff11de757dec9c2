// Pieces that no samples ask for: outliers that others confirm by chance leave bubbles of a few triangles.
#pragma once

#include <pointskin/reconstruct.hpp>

#include "diagnose/verdict.hpp"
#include "reconstruct/fit_field.hpp"

namespace pointskin::detail {

/// Pieces on which fewer samples lie go where some are lonely: outliers come alone or a few together, and a piece of a
/// scan with so few samples has no shape yet.
inline constexpr double kFewestSamples = 24;

/// True if a surface of the field loses its pieces without samples. Where a user says which pieces stay, that holds.
inline bool picks_pieces_by_support(const FieldData& field, const Options& options) {
  return !options.largest && options.min_component == 0 && !field.density.counts.empty() &&
         (field.drops_specks || diagnose::findings_of(field.seen).lonely > 0);
}

}  // namespace pointskin::detail
