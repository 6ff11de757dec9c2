// The solve on the complete levels: few iterations from coarse to fine, then multigrid cycles on the last of them.
// Sources: Briggs, Henson & McCormick, "A multigrid tutorial", 2nd ed., 2000, chapters 3 and 5; Saad, "Iterative methods for
// sparse linear systems", 2nd ed., algorithm 12.1. Differs: on coarser levels the samples' weights are lumped at the
// corners, which bounds them from above, so that a correction may fall short but never overshoots, however strong the
// screening is; and Chebyshev steps over the cycles make up for that (docs/decisions/0050-cycles-on-complete-levels.md).
#pragma once

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/view.hpp"
#include "poisson/chebyshev.hpp"
#include "poisson/operator.hpp"
#include "poisson/previous.hpp"

namespace pointskin::poisson {

/// Iterations of a level above the last.
inline constexpr int kFirstIterations = 3;

/// One thing that is done at all corners of a level, for its field or for the correction of the level below.
struct CompleteStep {
  enum Task : std::uint8_t {
    start,          ///< the field starts as the interpolation of the level above, or as poisson/previous.hpp has it
    relax,          ///< one Chebyshev step, from one of the two arrays into the other
    find_residual,  ///< of the field or the correction
    restrict_below,  ///< the residual of the level below becomes the system of a correction, which starts at 0 and takes its
                     ///< first Chebyshev step at once
    add_correction,  ///< of the level above, interpolated; to a field as a Chebyshev step over cycles
  };
  Task task;
  std::uint8_t level;
  bool of_correction;         ///< else of the field
  std::uint8_t from, above;   ///< which of the two arrays holds what is read, on this level and the one above
  ChebyshevStep chebyshev{};  ///< of relax, restrict_below, and add_correction to the field
};

/// Arrays of the complete levels, small enough to travel as a kernel's argument. Each has the nodes of its level.
struct CompleteLevels {
  static constexpr int kLevels = octree::kCompleteDepth + 1;

  int top = 0;
  LevelSystem fields[kLevels];                     ///< the unknowns are those that are free
  LevelSystem corrections[kLevels];                ///< of the levels above the last
  const std::uint8_t* unknowns[kLevels] = {};      ///< all of them: those that are not free are held at 0
  float* u[kLevels][2] = {};                       ///< of the fields
  float* e[kLevels][2] = {};                       ///< of the corrections
  float *b[kLevels] = {}, *weights[kLevels] = {};  ///< what `corrections` point to; the last level has weights alone
  float* residual[kLevels] = {};
  float *start = nullptr, *before = nullptr;  ///< of the last level: the field before a cycle, and before that

  PSK_HD const LevelSystem& system(const CompleteStep& step) const {
    return step.of_correction ? corrections[step.level] : fields[step.level];
  }
  /// One of the two arrays of the step's level.
  PSK_HD float* array(const CompleteStep& step, int which) const {
    return step.of_correction ? e[step.level][which] : u[step.level][which];
  }
};

/// Memory of CompleteLevels but for u[..][0].
struct CompleteScratch {
  exec::Buffer<float> floats;
};

/// Sets what CompleteLevels points to, of levels 0..top.
/// @param u  shape (nodes of all levels), receives the fields
template <exec::Space Exec>
CompleteScratch allocate_complete_levels(Exec& ex, ArrayView<float> u, CompleteLevels& levels);

/// Fills u[d][0] of all levels: a few iterations each, then as many cycles on the last as `iterations` stand for.
/// @param iterations  SolveOptions::iterations
/// @param previous    a field to start from, if it has values
/// @returns iterations of the field on the last level
/// One launch on a GPU where there is no field before, else one a step. Deterministic, the same bits on every device.
template <exec::Space Exec>
int solve_complete_levels(Exec& ex, const CompleteLevels& levels, int iterations, const PreviousField& previous);

}  // namespace pointskin::poisson
