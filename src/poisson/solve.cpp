#include "poisson/solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "exec/exact_sum.hpp"
#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "octree/placed.hpp"
#include "poisson/complete_solve.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/operator.hpp"
#include "poisson/previous_detail.hpp"
#include "poisson/relax_bricks.hpp"

namespace pointskin::poisson {
namespace {

/// u_d = interpolation of u_(d-1), into two arrays: iterations read one and write the other.
struct Prolong {
  octree::LevelView level, above;
  const float* above_u;
  ArrayView<float> u, other;
  [[nodiscard]] PSK_HD float value_at(std::int64_t n) const {
    return octree::prolonged(above, above_u, level.parent[n >> 3], static_cast<int>(n & 7));
  }
  PSK_HD void operator()(std::int64_t n) const {
    const float value = value_at(n);
    u[n] = value;
    other[n] = value;
  }
};

/// The same, and what the field before had added: the start of a level from that field.
struct ProlongWithDetail {
  Prolong prolong;
  Detail detail;
  PSK_HD void operator()(std::int64_t n) const {
    const float value = prolong.value_at(n) + detail(n);
    prolong.u[n] = value;
    prolong.other[n] = value;
  }
};

/// Units of exact sums, 2^-these: of squared residuals, and of values of the field, which are mostly about 0.5.
constexpr int kResidualFraction = 90;
constexpr int kValueFraction = 64;

/// Unknowns that are not solved for are 0; other corners keep what was interpolated.
struct HoldAtZero {
  const std::uint8_t *unknowns, *free;  // of the level
  ArrayView<float> u, other;
  PSK_HD void operator()(std::int64_t brick) const {
    const int held = unknowns[brick] & ~free[brick];
    if (held == 0) return;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s)
      if ((held >> s & 1) != 0) u[8 * brick + s] = other[8 * brick + s] = 0;
  }
};

struct SquaredResidual {
  LevelSystem system;
  const float* u;
  PSK_HD double operator()(std::int64_t brick) const {
    const int unknowns = system.level.unknowns[brick];
    if (unknowns == 0) return 0;
    const octree::Neighbourhood around = octree::load_neighbourhood(system.level, brick, u);
    const BrickResidual r = brick_residual(system, brick, around);
    double sum = 0;
    for (int s = 0; s < 8; ++s)
      if ((unknowns >> s & 1) != 0) sum += static_cast<double>(r.corner[s].residual) * r.corner[s].residual;
    return sum;
  }
};

struct CountUnknowns {
  const std::uint8_t* unknowns;
  PSK_HD std::int64_t operator()(std::int64_t brick) const {
    int count = 0;
    for (int bits = unknowns[brick]; bits != 0; bits &= bits - 1) ++count;
    return count;
  }
};

struct Plus {
  template <class T>
  PSK_HD T operator()(T a, T b) const {
    return a + b;
  }
};

/// Levels finer than the complete ones only have to resolve what their own cells add to the interpolated field. The lower end of
/// the part of the spectrum that is damped follows from how long they are iterated.
double lower_end(int iterations) {
  return std::clamp(4.0 / (static_cast<double>(iterations) * iterations), 0.005, 0.5);
}

template <exec::Space Exec>
double residual_norm(Exec& ex, const LevelSystem& system, const float* u) {
  return std::sqrt(
      exec::exact_sum(ex, "solve.residual", system.level.bricks, SquaredResidual{system, u}, kResidualFraction));
}

/// Iterations one after another, from one array into the other and back.
template <exec::Space Exec>
requires(!Exec::kOwnKernels) void relax(Exec& ex, const LevelSystem& system, const std::vector<ChebyshevStep>& steps,
                                        float* from, float* to) {
  for (const ChebyshevStep& chebyshev : steps) {
    for_each(ex, "solve.relax", system.level.bricks, RelaxBricks{system, chebyshev, from, to});
    std::swap(from, to);
  }
}

/// Iterates a level; the result ends in `u`. Both arrays hold the interpolated values before.
template <exec::Space Exec>
void iterate(Exec& ex, const LevelSystem& system, int iterations, float* u, float* other) {
  Chebyshev chebyshev(lower_end(iterations));
  std::vector<ChebyshevStep> steps(static_cast<std::size_t>(iterations));
  std::generate(steps.begin(), steps.end(), [&] { return chebyshev.next(); });
  const bool even = iterations % 2 == 0;
  relax(ex, system, steps, even ? u : other, even ? other : u);
}

/// Fills both arrays of a level: from the level above, and from the field before, if there is one; 0 where it is held there.
/// @param unknowns  of the level, those that are held among them
template <exec::Space Exec>
void start_level(Exec& ex, const PreviousField& before, const std::uint8_t* unknowns, const Prolong& prolong) {
  const octree::LevelView& level = prolong.level;
  if (before.u == nullptr) {
    for_each(ex, "solve.prolong", level.nodes(), prolong);
  } else {
    const octree::LevelView& old = before.tree.levels[level.depth];
    const octree::LevelView& above = before.tree.levels[level.depth - 1];
    const Detail detail{level,
                        old,
                        above,
                        before.u + old.first_node,
                        before.u + above.first_node,
                        before.bricks + level.first_node / 8};
    for_each(ex, "solve.start", level.nodes(), ProlongWithDetail{prolong, detail});
  }
  if (unknowns != level.unknowns)
    for_each(ex, "solve.hold", level.bricks, HoldAtZero{unknowns, level.unknowns, prolong.u, prolong.other});
}

struct SumOfValues {
  double sum = 0;
  std::int64_t count = 0;
};
struct SumInCell {
  ArrayView<const SumOfValues> cells;
  PSK_HD double operator()(std::int64_t cell) const { return cells[cell].sum; }
};

/// The same of many cells: exact.
struct ExactSumOfValues {
  exec::ExactSum sum;
  std::int64_t count = 0;
};
struct ExactlyInCell {
  ArrayView<const SumOfValues> cells;
  int fraction = kValueFraction;
  PSK_HD ExactSumOfValues operator()(std::int64_t cell) const {
    return {exec::exact_term(cells[cell].sum, fraction), cells[cell].count};
  }
};
struct AddSums {
  static constexpr bool kAnyOrder = true;
  PSK_HD ExactSumOfValues operator()(const ExactSumOfValues& a, const ExactSumOfValues& b) const {
    return {exec::AddExactly{}(a.sum, b.sum), a.count + b.count};
  }
};
/// The same of a block's own cells alone.
struct SumOfOwnValues {
  struct Total {
    ExactSumOfValues values;
    std::int64_t cells = 0;
    double largest = 0;  // magnitude of a cell's sum
  };
  struct Add {
    static constexpr bool kAnyOrder = true;
    PSK_HD Total operator()(const Total& a, const Total& b) const {
      return {AddSums{}(a.values, b.values), a.cells + b.cells, exec::Largest{}(a.largest, b.largest)};
    }
  };

  octree::LevelView level;
  ExactlyInCell values;
  std::uint64_t begin, end;
  PSK_HD Total operator()(std::int64_t cell) const {
    const std::uint64_t key = level.node_key(static_cast<std::int32_t>(cell));
    if (key < begin || key >= end) return {};
    const double sum = values.cells[cell].sum;
    return {values(cell), 1, sum < 0 ? -sum : sum};
  }
};

/// The samples of one finest cell that stand for some area: all samples lie in finest cells.
struct ValuesInCell {
  octree::LevelView level;
  const float* u;
  SamplesView samples;
  ArrayView<SumOfValues> out;
  PSK_HD void operator()(std::int64_t cell) const { out[cell] = total_of(cell); }

  [[nodiscard]] PSK_HD SumOfValues total_of(std::int64_t cell) const {
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t last = level.point_begin[cell + 1];
    SumOfValues total;
    if (first == last) return total;
    const auto node = static_cast<std::int32_t>(cell);
    const octree::Coordinates at = octree::decode(level.node_key(node));
    for (std::int32_t i = first; i < last; ++i) {
      if (!(samples.areas[i] > 0)) continue;
      const Vec3f local = octree::local_in_cell(samples.positions[i], at, level.depth);
      total.sum += octree::interpolated(level, u, node, local);
      ++total.count;
    }
    return total;
  }
};

/// The systems of all levels of one solve, and their values.
template <exec::Space Exec>
class Levels {
 public:
  Levels(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b, const Screening& screening,
         const SolveOptions& options, ArrayView<float> u)
      : ex_(ex), tree_(tree), b_(b), screening_(screening), options_(options), u_(u) {}

  /// The unknowns are those to solve for.
  [[nodiscard]] LevelSystem system(int d) const {
    octree::LevelView level = tree_.levels[d];
    if (!options_.free_unknowns.empty()) level.unknowns = options_.free_unknowns.data + level.first_node / 8;
    LevelSystem system{level, b_.data + level.first_node, {}, 0, make_axis_rows_f()};
    if (options_.screening > 0) {
      system.screening = screening_.view(d);
      system.screening_scale = static_cast<float>(std::ldexp(options_.screening, 2 * (d - tree_.depth)));
    }
    return system;
  }

  /// Levels 0..last.
  void solve_complete(int last, std::vector<LevelSolve>& done) {
    CompleteLevels levels;
    levels.top = last;
    for (int d = 0; d <= last; ++d) {
      levels.fields[d] = system(d);
      levels.unknowns[d] = tree_.levels[d].unknowns;
    }
    const CompleteScratch scratch = allocate_complete_levels(ex_, u_, levels);
    const int iterations = solve_complete_levels(ex_, levels, options_.iterations, options_.previous);
    for (int d = 0; d <= last; ++d) report(levels.fields[d], d == last ? iterations : kFirstIterations, done);
  }

  void solve(int d, std::vector<LevelSolve>& done) {
    const LevelSystem level = system(d);
    const auto placed = octree::placed_on_level(ex_, level.level);
    auto other = exec::make_buffer<float>(ex_, level.level.nodes());
    start(level, values(d), other.view());
    iterate(ex_, level, options_.iterations, values(d).data, other.data());
    other.reset();
    report(level, options_.iterations, done);
  }

 private:
  [[nodiscard]] ArrayView<float> values(int d) const {
    return u_.part(tree_.levels[d].first_node, tree_.levels[d].nodes());
  }

  void start(const LevelSystem& system, ArrayView<float> u, ArrayView<float> other) {
    const octree::LevelView& above = tree_.levels[system.level.depth - 1];
    start_level(ex_, options_.previous, tree_.levels[system.level.depth].unknowns,
                Prolong{system.level, above, u_.data + above.first_node, u, other});
  }

  /// Residuals are measured where they are asked for: that of the start, which is made once more, and that of the result.
  void report(const LevelSystem& system, int iterations, std::vector<LevelSolve>& done) {
    const octree::LevelView& level = system.level;
    LevelSolve solved{level.depth, 0, iterations};
    if (options_.residuals) {
      const auto placed = octree::placed_on_level(ex_, level);
      auto begin = exec::make_buffer<float>(ex_, level.nodes());
      if (level.depth == 0)
        exec::fill(ex_, begin.view(), 0.0F);
      else
        start(system, begin.view(), begin.view());
      solved.unknowns =
          exec::reduce<std::int64_t>(ex_, "solve.unknowns", level.bricks, CountUnknowns{level.unknowns}, Plus{});
      solved.residual_before = residual_norm(ex_, system, begin.data());
      solved.residual_after = residual_norm(ex_, system, values(level.depth).data);
    }
    done.push_back(solved);
  }

  Exec& ex_;
  const octree::OctreeView& tree_;
  ArrayView<const float> b_;
  const Screening& screening_;
  const SolveOptions& options_;
  ArrayView<float> u_;
};

}  // namespace

template <exec::Space Exec>
Solution solve_poisson(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b, const Screening& screening,
                       const SolveOptions& options) {
  Solution solution;
  {
    const auto placed = octree::placed_on_levels(ex, tree, tree.depth);
    solution.u = exec::make_buffer<float>(ex, tree.nodes);
  }
  Levels<Exec> levels(ex, tree, b, screening, options, solution.u.view());
  const auto announce = [&](int d) {
    if (options.before_level) options.before_level(d);
  };
  const int complete = std::min(tree.depth, octree::kCompleteDepth);
  for (int d = 0; d <= complete; ++d) announce(d);
  levels.solve_complete(complete, solution.levels);
  for (int d = complete + 1; d <= tree.depth; ++d) {
    announce(d);
    levels.solve(d, solution.levels);
  }
  return solution;
}

template <exec::Space Exec>
double mean_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u, const SamplesView& samples) {
  const octree::LevelView level = tree.view().finest();
  auto cells = exec::make_buffer<SumOfValues>(ex, level.cells());
  for_each(ex, "solve.isovalue", level.cells(), ValuesInCell{level, u.data + level.first_node, samples, cells.view()});
  const auto total =
      exec::reduce<ExactSumOfValues>(ex, "solve.isovalue", cells.size(), ExactlyInCell{cells.cview()}, AddSums{});
  const double sum = total.sum.reliable(cells.size())
                         ? total.sum.value(kValueFraction)
                         : exec::exact_sum(ex, "solve.isovalue", cells.size(), SumInCell{cells.cview()});
  return sum / static_cast<double>(total.count);
}

template <exec::Space Exec>
std::vector<LevelSolve> solve_below(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b,
                                    const Screening& screening, const SolveOptions& options, int level,
                                    ArrayView<float> u) {
  std::vector<LevelSolve> done;
  Levels<Exec> levels(ex, tree, b, screening, options, u);
  for (int d = level + 1; d <= tree.depth; ++d) {
    if (options.before_level) options.before_level(d);
    levels.solve(d, done);
  }
  return done;
}

template <exec::Space Exec>
ValuesOfSamples values_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u,
                                  const SamplesView& samples, std::uint64_t begin, std::uint64_t end, int fraction) {
  static_assert(ValuesOfSamples::kFraction == kValueFraction);
  const octree::LevelView level = tree.view().finest();
  auto cells = exec::make_buffer<SumOfValues>(ex, level.cells());
  for_each(ex, "solve.isovalue", level.cells(), ValuesInCell{level, u.data + level.first_node, samples, cells.view()});
  const auto total = exec::reduce<SumOfOwnValues::Total>(ex, "solve.isovalue", cells.size(),
                                                         SumOfOwnValues{level, {cells.cview(), fraction}, begin, end},
                                                         SumOfOwnValues::Add{});
  return {total.values.sum, total.values.count, total.cells, total.largest};
}

PSK_INSTANTIATE(solve_poisson);
PSK_INSTANTIATE(solve_below);
PSK_INSTANTIATE(values_at_samples);
PSK_INSTANTIATE(mean_at_samples);

}  // namespace pointskin::poisson
