#include "poisson/complete_solve.hpp"

#include <algorithm>
#include <utility>

#include "exec/this_space.hpp"
#include "poisson/complete_steps.hpp"
#include "poisson/previous_detail.hpp"
#include "poisson/relax_bricks.hpp"

namespace pointskin::poisson {
namespace {

/// A step that is done node by node.
struct StepAtNode {
  CompleteAt at;
  CompleteStep step;
  PSK_HD void operator()(std::int64_t n) const { at(step, n); }
};

/// The start from a field before.
struct StartWithDetail {
  CompleteAt at;
  CompleteStep step;
  Detail detail;
  PSK_HD void operator()(std::int64_t n) const { at.start(step, n, detail(n)); }
};

struct ResidualOfBrick {
  CompleteAt at;
  CompleteStep step;
  PSK_HD void operator()(std::int64_t brick) const {
    const LevelSystem& system = at.levels.system(step);
    const int unknowns = system.level.unknowns[brick];
    BrickResidual r;
    if (unknowns != 0)
      r = brick_residual(system, brick,
                         octree::load_neighbourhood(system.level, brick, at.levels.array(step, step.from)));
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) at.keep_residual(step, 8 * brick + s, (unknowns >> s & 1) != 0, r.corner[s]);
  }
};

template <exec::Space Exec>
void do_start(Exec& ex, const CompleteLevels& levels, const CompleteStep& step, const PreviousField& before) {
  const octree::LevelView& level = levels.fields[step.level].level;
  if (before.u == nullptr || step.level == 0)
    return for_each(ex, "solve.start", level.nodes(), StepAtNode{{levels}, step});
  const octree::LevelView& old = before.tree.levels[level.depth];
  const octree::LevelView& above = before.tree.levels[level.depth - 1];
  const Detail detail{
      level, old, above, before.u + old.first_node, before.u + above.first_node, before.bricks + level.first_node / 8};
  for_each(ex, "solve.start", level.nodes(), StartWithDetail{{levels}, step, detail});
}

template <exec::Space Exec>
void do_step(Exec& ex, const CompleteLevels& levels, const CompleteStep& step, const PreviousField& previous) {
  const LevelSystem& system = levels.system(step);
  switch (step.task) {
    case CompleteStep::start:
      return do_start(ex, levels, step, previous);
    case CompleteStep::relax:
      return for_each(
          ex, "solve.relax", system.level.bricks,
          RelaxBricks{system, step.chebyshev, levels.array(step, step.from), levels.array(step, 1 - step.from)});
    case CompleteStep::find_residual:
      return for_each(ex, "solve.correct", system.level.bricks, ResidualOfBrick{{levels}, step});
    case CompleteStep::restrict_below:
    case CompleteStep::add_correction:
      return for_each(ex, "solve.correct", system.level.nodes(), StepAtNode{{levels}, step});
  }
}

/// All steps, one after another. A GPU has a kernel of its own for it (complete_solve_kernel.cuh).
template <exec::Space Exec>
requires(!Exec::kOwnKernels) void do_steps(Exec& ex, const CompleteLevels& levels,
                                           const std::vector<CompleteStep>& plan) {
  for (const CompleteStep& step : plan) do_step(ex, levels, step, {});
}

/// At least so many; from a field before more, as it differs far away from where it was changed, too.
constexpr int kCycles = 1, kCyclesFromBefore = 3;

/// Makes a plan. Of each array that is relaxed it knows which of the two holds the result.
class Planner {
 public:
  explicit Planner(int top) : top_(top) {}

  /// @param fewest_cycles  on the last level, if there is one above kBottom
  std::vector<CompleteStep> plan(int iterations, int fewest_cycles) {
    for (int d = 0; d < top_; ++d) start(d, kFirstIterations);
    if (top_ <= kBottom) {
      start(top_, std::max(iterations, kLeastAlone));
      return std::move(steps_);
    }
    start(top_, 0);
    const int cycles = std::max(fewest_cycles, (iterations + 3) / 4);
    const double upper = cycles_upper(cycles);
    Chebyshev over_cycles(kCyclesLower / upper);
    for (int i = 0; i < cycles; ++i) {
      relax(top_, false, kSmoothing, kSmoothingLower);
      ChebyshevStep step = over_cycles.next();
      step.gain /= static_cast<float>(upper);
      correct(top_, false, step);
    }
    relax(top_, false, kSmoothing, kSmoothingLower);
    return std::move(steps_);
  }

 private:
  static constexpr int kBottom = 2;  // the level that is not corrected itself
  static constexpr int kBottomIterations = 4, kLeastAlone = 12;
  static constexpr int kSmoothing = 2;  // before a correction and after it
  static constexpr double kFirstLower = 0.1, kSmoothingLower = 0.2, kBottomLower = 0.06;
  static constexpr double kCyclesLower = 0.2;

  /// What a cycle takes of an error is 1 at most, but for what iterations turn the sign of: two do of up to 0.29 of it, four at the
  /// bottom of up to 0.26. The iterations that end the solve damp what two cycles add there; more need an interval that holds it.
  static double cycles_upper(int cycles) { return cycles <= 2 ? 1.0 : 1.3; }

  void start(int level, int iterations) {
    add(CompleteStep::start, level);
    field_[level] = iterations % 2;  // so that the last one ends in array 0
    relax(level, false, iterations, kFirstLower);
  }

  int& now(int level, bool of_correction) { return of_correction ? correction_[level] : field_[level]; }

  void add(CompleteStep::Task task, int level, bool of_correction = false, const ChebyshevStep& chebyshev = {}) {
    const int above = level > 0 ? correction_[level - 1] : 0;
    steps_.push_back({task, static_cast<std::uint8_t>(level), of_correction,
                      static_cast<std::uint8_t>(now(level, of_correction)), static_cast<std::uint8_t>(above),
                      chebyshev});
  }

  void relax(int level, bool of_correction, int iterations, double lower) {
    Chebyshev chebyshev(lower);
    for (int i = 0; i < iterations; ++i) relax_once(level, of_correction, chebyshev);
  }
  void relax_once(int level, bool of_correction, Chebyshev& chebyshev) {
    add(CompleteStep::relax, level, of_correction, chebyshev.next());
    now(level, of_correction) ^= 1;
  }

  /// A correction of the level below: its system, and iterations from 0.
  void begin_correction(int level, int iterations, double lower) {
    Chebyshev chebyshev(lower);
    correction_[level] = 0;
    add(CompleteStep::restrict_below, level, true, chebyshev.next());
    correction_[level] = 1;
    for (int i = 1; i < iterations; ++i) relax_once(level, true, chebyshev);
  }

  void correct(int level, bool of_correction, const ChebyshevStep& over_cycles) {
    const int above = level - 1;
    add(CompleteStep::find_residual, level, of_correction);
    if (above <= kBottom) {
      begin_correction(above, kBottomIterations, kBottomLower);
    } else {
      begin_correction(above, kSmoothing, kSmoothingLower);
      correct(above, true, {});
      relax(above, true, kSmoothing, kSmoothingLower);
    }
    add(CompleteStep::add_correction, level, of_correction, over_cycles);
  }

  int top_;
  int field_[CompleteLevels::kLevels] = {}, correction_[CompleteLevels::kLevels] = {};
  std::vector<CompleteStep> steps_;
};

}  // namespace

template <exec::Space Exec>
CompleteScratch allocate_complete_levels(Exec& ex, ArrayView<float> u, CompleteLevels& levels) {
  const int top = levels.top;
  const auto nodes = [&](int d) { return levels.fields[d].level.nodes(); };
  std::int64_t size = 5 * nodes(top);
  for (int d = 0; d < top; ++d) size += 6 * nodes(d);
  CompleteScratch scratch{exec::make_buffer<float>(ex, size)};
  std::int64_t used = 0;
  const auto take = [&](int d) {
    float* const array = scratch.floats.data() + used;
    used += nodes(d);
    return array;
  };
  for (int d = 0; d <= top; ++d) {
    levels.u[d][0] = u.data + levels.fields[d].level.first_node;
    levels.u[d][1] = take(d);
    levels.residual[d] = take(d);
    levels.weights[d] = take(d);
    if (d == top) break;
    levels.b[d] = take(d);
    levels.e[d][0] = take(d);
    levels.e[d][1] = take(d);
    levels.corrections[d] = {levels.fields[d].level, levels.b[d], {}, 0, levels.fields[d].rows, levels.weights[d]};
  }
  levels.start = take(top);
  levels.before = take(top);
  return scratch;
}

template <exec::Space Exec>
int solve_complete_levels(Exec& ex, const CompleteLevels& levels, int iterations, const PreviousField& previous) {
  const std::vector<CompleteStep> plan =
      Planner(levels.top).plan(iterations, previous.u == nullptr ? kCycles : kCyclesFromBefore);
  if (previous.u == nullptr)
    do_steps(ex, levels, plan);
  else
    for (const CompleteStep& step : plan) do_step(ex, levels, step, previous);
  return static_cast<int>(std::count_if(plan.begin(), plan.end(), [&](const CompleteStep& step) {
    return step.task == CompleteStep::relax && !step.of_correction && step.level == levels.top;
  }));
}

PSK_INSTANTIATE(allocate_complete_levels);
PSK_INSTANTIATE(solve_complete_levels);

}  // namespace pointskin::poisson
