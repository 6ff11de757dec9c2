// A set operation on two solids, from their points or meshes to the mesh of the result: what the public Booleans does.
#pragma once

#include <pointskin/boolean.hpp>

#include "exec/space.hpp"

namespace pointskin::boolean {

/// As Booleans::combine, but for BooleanReport::total_ms.
/// @param options  valid
template <exec::Space Exec>
BooleanResult combine(Exec& ex, const BooleanOperand& a, const BooleanOperand& b, BooleanOp op,
                      const BooleanOptions& options);

}  // namespace pointskin::boolean
