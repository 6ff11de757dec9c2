// A surface without what lies on one side of a line on it.
#pragma once

#include "exec/space.hpp"
#include "surface/extract.hpp"
#include "surface/trim_pieces.hpp"

namespace pointskin::surface {

/// Splits the triangles across the line and leaves out what is cut away.
/// @param surface  whose arrays `mesh` looks at; they are freed as soon as they are not needed any more
/// O(t log t) for t triangles across the line, O(v + t) else. Deterministic.
template <exec::Space Exec>
Surface split_surface(Exec& ex, Surface surface, const trim::SidesView& mesh);

}  // namespace pointskin::surface
