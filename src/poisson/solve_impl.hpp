#pragma once

#include <algorithm>
#include <cmath>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "poisson/operator.hpp"
#include "poisson/solve.hpp"

namespace pointskin::poisson {
namespace solve {

/// u_d = interpolation of u_(d-1), into two arrays: iterations read one and write the other.
struct Prolong {
  octree::LevelView level, above;
  const float* above_u;
  ArrayView<float> u, other;
  PSK_HD void operator()(std::int64_t n) const {
    const float value = octree::prolonged(above, above_u, level.parent[n >> 3], static_cast<int>(n & 7));
    u[n] = value;
    other[n] = value;
  }
};

/// One Chebyshev iteration:  step = momentum step + gain diagonal^-1 (b - A u);  next = u + step.
struct Relax {
  LevelSystem system;
  float momentum, gain;
  const float* u;
  float* step;
  float* next;
  PSK_HD void operator()(std::int64_t brick) const {
    const int unknowns = system.level.unknowns[brick];
    if (unknowns == 0) return;  // `next` holds the interpolated values already
    const octree::Neighbourhood around = octree::load_neighbourhood(system.level, brick, u);
    const BrickResidual r = brick_residual(system, brick, around);
    PSK_UNROLL for (int s = 0; s < 8; ++s) {
      const std::int64_t n = 8 * brick + s;
      float change = gain * (r.residual[s] / r.diagonal[s]);
      if (momentum != 0) change += momentum * step[n];
      if ((unknowns >> s & 1) == 0) change = 0;
      step[n] = change;
      next[n] = around.at(octree::slot_x(s), octree::slot_y(s), octree::slot_z(s)) + change;
    }
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
      if ((unknowns >> s & 1) != 0) sum += static_cast<double>(r.residual[s]) * r.residual[s];
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

/// Complete levels are iterated longer, over their whole spectrum, whose lower end is about 2 / cells^2: they carry the
/// far field, and they are cheap. The finest of them mends what the few iterations above left. Finer levels only have
/// to resolve what their own cells add to the interpolated field.
inline Schedule schedule_for(int depth, int iterations) {
  if (depth > octree::kCompleteDepth)
    return {iterations, std::clamp(4.0 / (static_cast<double>(iterations) * iterations), 0.005, 0.5)};
  const double cells = std::pow(2.0, depth);
  return {std::max(iterations, static_cast<int>(3 * cells)), std::min(0.1, 2.0 / (cells * cells))};
}

/// Coefficients of Chebyshev iterations on [lower, 1].
class Chebyshev {
 public:
  explicit Chebyshev(double lower) : theta_((1 + lower) / 2), delta_((1 - lower) / 2), rho_(delta_ / theta_) {}

  struct Step {
    float momentum, gain;
  };
  Step next() {
    if (first_) {
      first_ = false;
      return {0, static_cast<float>(1 / theta_)};
    }
    const double rho = 1 / (2 * theta_ / delta_ - rho_);
    const Step step{static_cast<float>(rho * rho_), static_cast<float>(2 * rho / delta_)};
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
  auto step = exec::make_buffer<float>(ex, level.nodes());
  Chebyshev chebyshev(schedule.lower);
  float* from = schedule.iterations % 2 == 0 ? u : other;
  float* to = schedule.iterations % 2 == 0 ? other : u;
  for (int k = 0; k < schedule.iterations; ++k) {
    const Chebyshev::Step s = chebyshev.next();
    for_each(ex, "solve.relax", level.bricks, Relax{system, s.momentum, s.gain, from, step.data(), to});
    std::swap(from, to);
  }
  if (options.residuals) report.residual_after = residual_norm(ex, system, u);
  return report;
}

struct WeightedValue {
  double sum = 0, weight = 0;
};
struct AddWeighted {
  PSK_HD WeightedValue operator()(const WeightedValue& a, const WeightedValue& b) const {
    return {a.sum + b.sum, a.weight + b.weight};
  }
};
struct ValueAtSample {
  octree::OctreeView tree;
  const float* u;
  SamplesView samples;
  PSK_HD WeightedValue operator()(std::int64_t i) const {
    const double area = samples.areas[i];
    return {area * octree::value_at(tree, u, samples.positions[i], tree.depth), area};
  }
};

}  // namespace solve

template <exec::Space Exec>
Solution solve_poisson(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> b, const Screening& screening,
                       const SolveOptions& options) {
  const octree::OctreeView view = tree.view();
  Solution solution{exec::make_buffer<float>(ex, view.nodes), {}};
  const ArrayView<float> all = solution.u.view();
  for (int d = 0; d <= view.depth; ++d) {
    if (options.before_level) options.before_level(d);
    const octree::LevelView& level = view.levels[d];
    LevelSystem system{level, b.data + level.first_node, {}, 0, make_axis_rows_f()};
    if (options.screening > 0) {
      system.screening = screening.view(d);
      system.screening_scale = static_cast<float>(std::ldexp(options.screening, 2 * (d - view.depth)));
    }
    const ArrayView<float> u = all.part(level.first_node, level.nodes());
    auto other = exec::make_buffer<float>(ex, level.nodes());
    if (d == 0) {
      exec::fill(ex, u, 0.0F);
      exec::fill(ex, other.view(), 0.0F);
    } else {
      const octree::LevelView& above = view.levels[d - 1];
      for_each(ex, "solve.prolong", level.nodes(),
               solve::Prolong{level, above, all.data + above.first_node, u, other.view()});
    }
    solution.levels.push_back(solve::solve_level(ex, system, options, u.data, other.data()));
  }
  return solution;
}

template <exec::Space Exec>
double mean_at_samples(Exec& ex, const octree::OctreeData& tree, ArrayView<const float> u, const SamplesView& samples) {
  const auto total =
      exec::reduce<solve::WeightedValue>(ex, "solve.isovalue", samples.positions.size,
                                         solve::ValueAtSample{tree.view(), u.data, samples}, solve::AddWeighted{});
  return total.sum / total.weight;
}

}  // namespace pointskin::poisson
