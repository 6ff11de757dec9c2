#include "poisson/solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
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

/// How long and on which part of the spectrum a level is iterated.
struct Schedule {
  int iterations;
  double lower;  ///< eigenvalues of diagonal^-1 A in [lower, 1] are damped evenly
};

/// Complete levels are iterated longer: they carry the far field, and the surface over holes, and they are cheap. All but the
/// last over their whole spectrum, whose lower end is about 2 / cells^2; levels 0 and 1 only give the next ones a start. The
/// last, whose start is good, three times as long as finer levels, which only have to resolve what their own cells add to the
/// interpolated field.
Schedule schedule_for(int depth, int iterations) {
  if (depth > octree::kCompleteDepth)
    return {iterations, std::clamp(4.0 / (static_cast<double>(iterations) * iterations), 0.005, 0.5)};
  const int cells = 1 << depth;  // along an axis
  if (depth == octree::kCompleteDepth) {
    const double count = 3.0 * iterations;
    return {3 * iterations, std::clamp(4.5 / (count * count), 0.004, 0.5)};
  }
  const int asked = depth < 2 ? iterations / 4 : iterations;
  return {std::max(asked, 2 * cells), std::min(0.1, 2.0 / (cells * cells))};
}

/// Coefficients of Chebyshev iterations on [lower, 1].
class Chebyshev {
 public:
  explicit Chebyshev(double lower) : theta_((1 + lower) / 2), delta_((1 - lower) / 2), rho_(delta_ / theta_) {}

  ChebyshevStep next() {
    if (first_) {
      first_ = false;
      return {0, static_cast<float>(1 / theta_)};
    }
    const double rho = 1 / (2 * theta_ / delta_ - rho_);
    const ChebyshevStep step{static_cast<float>(rho * rho_), static_cast<float>(2 * rho / delta_)};
    rho_ = rho;
    return step;
  }

 private:
  double theta_, delta_, rho_;
  bool first_ = true;
};

template <exec::Space Exec>
double residual_norm(Exec& ex, const LevelSystem& system, const float* u) {
  return std::sqrt(exec::reduce<double>(ex, "solve.residual", system.level.bricks, SquaredResidual{system, u}, Plus{}));
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

/// The iterations of a schedule; the result ends in `u`.
template <exec::Space Exec>
void iterate(Exec& ex, const LevelSystem& system, const Schedule& schedule, float* u, float* other) {
  Chebyshev chebyshev(schedule.lower);
  std::vector<ChebyshevStep> steps(static_cast<std::size_t>(schedule.iterations));
  std::generate(steps.begin(), steps.end(), [&] { return chebyshev.next(); });
  const bool even = schedule.iterations % 2 == 0;
  relax(ex, system, steps, even ? u : other, even ? other : u);
}

/// Iterates one level; the result ends in `u`. Both arrays hold the interpolated values before.
template <exec::Space Exec>
LevelSolve solve_level(Exec& ex, const LevelSystem& system, const SolveOptions& options, float* u, float* other) {
  const octree::LevelView& level = system.level;
  const Schedule schedule = schedule_for(level.depth, options.iterations);
  LevelSolve report{level.depth, 0, schedule.iterations};
  if (options.residuals) {
    report.unknowns =
        exec::reduce<std::int64_t>(ex, "solve.unknowns", level.bricks, CountUnknowns{level.unknowns}, Plus{});
    report.residual_before = residual_norm(ex, system, u);
  }
  iterate(ex, system, schedule, u, other);
  if (options.residuals) report.residual_after = residual_norm(ex, system, u);
  return report;
}

/// Fills both arrays of a level: from the level above, and from the field before, if there is one.
template <exec::Space Exec>
void start_level(Exec& ex, const PreviousField& before, const Prolong& prolong) {
  const octree::LevelView& level = prolong.level;
  if (before.u == nullptr) return for_each(ex, "solve.prolong", level.nodes(), prolong);
  const octree::LevelView& old = before.tree.levels[level.depth];
  const octree::LevelView& above = before.tree.levels[level.depth - 1];
  const Detail detail{
      level, old, above, before.u + old.first_node, before.u + above.first_node, before.bricks + level.first_node / 8};
  for_each(ex, "solve.start", level.nodes(), ProlongWithDetail{prolong, detail});
}

struct SumOfValues {
  double sum = 0;
  std::int64_t count = 0;
};
struct AddSums {
  PSK_HD SumOfValues operator()(const SumOfValues& a, const SumOfValues& b) const {
    return {a.sum + b.sum, a.count + b.count};
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

}  // namespace

template <exec::Space Exec>
Solution solve_poisson(Exec& ex, const octree::OctreeView& tree, ArrayView<const float> b, const Screening& screening,
                       const SolveOptions& options) {
  Solution solution{exec::make_buffer<float>(ex, tree.nodes), {}};
  const ArrayView<float> all = solution.u.view();
  for (int d = 0; d <= tree.depth; ++d) {
    if (options.before_level) options.before_level(d);
    octree::LevelView level = tree.levels[d];
    const bool holds = !options.free_unknowns.empty();
    if (holds) level.unknowns = options.free_unknowns.data + level.first_node / 8;
    LevelSystem system{level, b.data + level.first_node, {}, 0, make_axis_rows_f()};
    if (options.screening > 0) {
      system.screening = screening.view(d);
      system.screening_scale = static_cast<float>(std::ldexp(options.screening, 2 * (d - tree.depth)));
    }
    const ArrayView<float> u = all.part(level.first_node, level.nodes());
    auto other = exec::make_buffer<float>(ex, level.nodes());
    if (d == 0) {
      exec::fill(ex, u, 0.0F);
      exec::fill(ex, other.view(), 0.0F);
    } else {
      const octree::LevelView& above = tree.levels[d - 1];
      start_level(ex, options.previous, Prolong{level, above, all.data + above.first_node, u, other.view()});
    }
    if (holds)
      for_each(ex, "solve.hold", level.bricks, HoldAtZero{tree.levels[d].unknowns, level.unknowns, u, other.view()});
    solution.levels.push_back(solve_level(ex, system, options, u.data, other.data()));
  }
  return solution;
}

template <exec::Space Exec>
double mean_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u, const SamplesView& samples) {
  const octree::LevelView level = tree.view().finest();
  auto cells = exec::make_buffer<SumOfValues>(ex, level.cells());
  for_each(ex, "solve.isovalue", level.cells(), ValuesInCell{level, u.data + level.first_node, samples, cells.view()});
  const auto total = exec::reduce<SumOfValues>(ex, "solve.isovalue", cells.size(),
                                               exec::LoadValue<SumOfValues>{cells.cview()}, AddSums{});
  return total.sum / static_cast<double>(total.count);
}

PSK_INSTANTIATE(solve_poisson);
PSK_INSTANTIATE(mean_at_samples);

}  // namespace pointskin::poisson
