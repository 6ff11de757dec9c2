// What the steps on the complete levels do at one corner, or at those of a brick.
#pragma once

#include <cstdint>

#include "octree/access.hpp"
#include "poisson/complete_solve.hpp"
#include "poisson/operator.hpp"

namespace pointskin::poisson {

/// At one corner: for spaces with many threads all of it, for others what is not done a brick at a time.
struct CompleteAt {
  CompleteLevels levels;

  PSK_HD static bool is_among(const std::uint8_t* unknowns, std::int64_t n) {
    return (unknowns[n >> 3] >> (n & 7) & 1) != 0;
  }

  /// @param detail  what a field before adds to the interpolated value
  PSK_HD void start(const CompleteStep& step, std::int64_t n, float detail) const {
    const int d = step.level;
    const octree::LevelView& level = levels.fields[d].level;
    float value = detail;
    if (d > 0)
      value += octree::prolonged(levels.fields[d - 1].level, levels.u[d - 1][0], level.parent[n >> 3],
                                 static_cast<int>(n & 7));
    if (is_among(levels.unknowns[d], n) && !is_among(level.unknowns, n)) value = 0;
    levels.u[d][0][n] = value;
    levels.u[d][1][n] = value;
    if (d == levels.top && levels.start != nullptr) levels.start[n] = levels.before[n] = value;
  }

  PSK_HD void relax(const CompleteStep& step, std::int64_t n) const {
    const LevelSystem& system = levels.system(step);
    if (!is_among(system.level.unknowns, n)) return;  // both arrays hold what it keeps
    float value;
    const CornerResidual r = CornerOperator(system, n).residual(levels.array(step, step.from), value);
    float& out = levels.array(step, 1 - step.from)[n];
    out = step.chebyshev.next(value, out, r.residual / r.diagonal);
  }

  PSK_HD void find_residual(const CompleteStep& step, std::int64_t n) const {
    const LevelSystem& system = levels.system(step);
    CornerResidual r;
    float value;
    const bool is_unknown = is_among(system.level.unknowns, n);
    if (is_unknown) r = CornerOperator(system, n).residual(levels.array(step, step.from), value);
    keep_residual(step, n, is_unknown, r);
  }

  PSK_HD void keep_residual(const CompleteStep& step, std::int64_t n, bool is_unknown, const CornerResidual& r) const {
    levels.residual[step.level][n] = is_unknown ? r.residual : 0;
    if (!step.of_correction) levels.weights[step.level][n] = is_unknown ? r.diagonal - kLargestEigenvalue : 0;
  }

  PSK_HD void restrict_below(const CompleteStep& step, std::int64_t n) const {
    const int d = step.level;
    const octree::LevelView& level = levels.fields[d].level;
    const octree::LevelView& below = levels.fields[d + 1].level;
    const auto node = static_cast<std::int32_t>(n);
    levels.b[d][n] = 0.5F * octree::restricted(level, below, levels.residual[d + 1], node);
    levels.weights[d][n] = 0.5F * octree::restricted(level, below, levels.weights[d + 1], node);
    levels.e[d][0][n] = 0;
    levels.e[d][1][n] = is_among(level.unknowns, n) ? first_correction(step, levels.b[d][n], levels.weights[d][n]) : 0;
  }

  /// What relax() makes of a correction that is 0 everywhere, with the same bits: there, the residual is b.
  PSK_HD static float first_correction(const CompleteStep& step, float b, float weight) {
    return step.chebyshev.next(0.0F, 0.0F, b / (kLargestEigenvalue + weight));
  }

  PSK_HD void add_correction(const CompleteStep& step, std::int64_t n) const {
    const int d = step.level;
    const octree::LevelView& level = levels.fields[d].level;
    if (!is_among(level.unknowns, n)) return;
    float& out = levels.array(step, step.from)[n];
    const float corrected = out + octree::prolonged(levels.fields[d - 1].level, levels.e[d - 1][step.above],
                                                    level.parent[n >> 3], static_cast<int>(n & 7));
    if (step.of_correction) {
      out = corrected;
      return;
    }
    const float value = levels.start[n];
    out = step.chebyshev.next(value, levels.before[n], corrected - value);
    levels.before[n] = value;
    levels.start[n] = out;
  }

  PSK_HD void operator()(const CompleteStep& step, std::int64_t n) const {
    switch (step.task) {
      case CompleteStep::start:
        return start(step, n, 0);
      case CompleteStep::relax:
        return relax(step, n);
      case CompleteStep::find_residual:
        return find_residual(step, n);
      case CompleteStep::restrict_below:
        return restrict_below(step, n);
      case CompleteStep::add_correction:
        return add_correction(step, n);
    }
  }
};

}  // namespace pointskin::poisson
