// The level-by-level solve against direct solves and against a solution that is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "poisson/density.hpp"
#include "poisson/divergence.hpp"
#include "poisson/resolution.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "unit/poisson/known_solution.hpp"
#include "unit/poisson/reference_system.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

/// Samples, of a sphere or others, ready to be solved.
struct Problem {
  explicit Problem(int depth, std::int64_t points = 1500)
      : Problem([&] { return test::sphere_tree(points, 0.3, depth); }) {}
  template <class MakeTree>
  requires std::invocable<MakeTree>
  explicit Problem(const MakeTree& make_tree) : tree(make_tree()) {
    poisson::weigh_samples(tree.ex, tree.tree, {1.5, false}, tree.samples);
    poisson::find_resolution(tree.ex, tree.tree, tree.samples);  // for the splat depths: all cells count here
    b = poisson::splat_divergence(tree.ex, tree.tree, tree.samples.view(), {});
    screening = poisson::collapse_samples(tree.ex, tree.tree, tree.samples.view());
  }
  poisson::Solution solve(const poisson::SolveOptions& options) {
    return poisson::solve_poisson(tree.ex, tree.view, b.cview(), screening, options);
  }

  SmallTree tree;
  exec::Buffer<float> b;
  poisson::Screening screening;
};

Eigen::VectorXd level_values(const octree::LevelView& level, const float* all) {
  Eigen::VectorXd values(level.nodes());
  for (std::int64_t n = 0; n < level.nodes(); ++n) values[n] = static_cast<double>(all[level.first_node + n]);
  return values;
}

/// Largest difference over the unknowns.
double difference(const test::ReferenceSystem& system, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  double worst = 0;
  for (const std::int64_t n : system.unknowns) worst = std::max(worst, std::abs(a[n] - b[n]));
  return worst;
}

// The field runs from 0 to 1. 1000 Chebyshev iterations damp everything above 0.005 of the bound to nothing; what is
// left is the rounding of float, amplified by the condition of the complete levels, some 10^3 at depth 4.
constexpr double kConverged = 1e-3;

TEST(Solve, EqualsTheDirectGalerkinSolutionWithScreening) {
  Problem problem(6);
  const double w = 4;
  const poisson::Solution solution = problem.solve({w, 1000, true});
  for (int d = octree::kCompleteDepth; d <= 6; ++d) {  // coarser levels are starting values
    const octree::LevelView& level = problem.tree.view.levels[d];
    const auto system = test::assemble(level, problem.screening.view(d), std::ldexp(w, 2 * (d - 6)));
    const Eigen::VectorXd u = level_values(level, solution.u.data());
    const Eigen::VectorXd direct = test::solve_directly(system, level_values(level, problem.b.data()), u);
    EXPECT_LT(difference(system, u, direct), kConverged) << "level " << d;
    EXPECT_EQ(solution.levels[static_cast<std::size_t>(d)].unknowns, static_cast<std::int64_t>(system.unknowns.size()));
  }
}

TEST(Solve, EqualsTheDirectGalerkinSolutionOfAdaptiveLevelsWithoutScreening) {
  Problem problem(6);
  const poisson::Solution solution = problem.solve({0, 1000, false});
  for (int d = octree::kCompleteDepth + 1; d <= 6; ++d) {  // coarser levels leave a constant open
    const octree::LevelView& level = problem.tree.view.levels[d];
    const auto system = test::assemble(level, {}, 0);
    const Eigen::VectorXd u = level_values(level, solution.u.data());
    const Eigen::VectorXd direct = test::solve_directly(system, level_values(level, problem.b.data()), u);
    EXPECT_LT(difference(system, u, direct), kConverged) << "level " << d;
  }
}

/// sqrt(e A e) of the error of a level's unknowns.
double energy_error(const octree::LevelView& level, const test::ReferenceSystem& system, const Eigen::VectorXd& u,
                    const Eigen::VectorXd& direct) {
  Eigen::VectorXd error = u - direct;
  for (std::int64_t n = 0; n < level.nodes(); ++n)
    if (!test::is_unknown(level, n)) error[n] = 0;  // nodes outside of the cube mean nothing
  return std::sqrt(error.dot(system.matrix * error));
}

/// Energy of the error of the last complete level over that of a field of 0.
double error_left(Problem& problem, double w, int iterations, int depth) {
  const int d = std::min(depth, octree::kCompleteDepth);
  const octree::LevelView& level = problem.tree.view.levels[d];
  const auto system = test::assemble(level, problem.screening.view(d), std::ldexp(w, 2 * (d - depth)));
  const poisson::Solution solution = problem.solve({w, iterations, false});
  const Eigen::VectorXd u = level_values(level, solution.u.data());
  const Eigen::VectorXd direct = test::solve_directly(system, level_values(level, problem.b.data()), u);
  return energy_error(level, system, u, direct) / energy_error(level, system, Eigen::VectorXd::Zero(u.size()), direct);
}

std::vector<Vec3f> random_normals(test::Random& random, int n) {
  std::vector<Vec3f> normals;
  for (int i = 0; i < n; ++i) {
    const Vec3d v{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
    normals.push_back(to_float(normalized(v)));
  }
  return normals;
}

TEST(Solve, SolvesTheLastCompleteLevel) {
  for (int depth = 1; depth <= octree::kCompleteDepth + 1; ++depth) {
    Problem problem(depth, 6000);  // dense on all levels: there screening is the hardest
    EXPECT_LT(error_left(problem, 4, 8, depth), 0.1) << "depth " << depth;
  }
}

// Weights of the samples from 1 to 1000 times the default. On coarser levels they are lumped, so that a cycle never goes
// beyond what it corrects; with Galerkin's own weights or those of the levels' samples, cycles diverge here.
TEST(Solve, CyclesComeCloserHoweverStrongTheScreening) {
  test::Random random(12);
  Problem scattered(
      [&] { return SmallTree(test::clustered_points(random, 40, 100, 0.03), random_normals(random, 4000), 6); });
  Problem sphere(6, 6000);
  for (Problem* problem : {&scattered, &sphere})
    for (const double w : {0.5, 4.0, 200.0, 4000.0}) {
      double last = 0.6;
      for (const int iterations : {8, 16, 32, 64}) {
        const double left = error_left(*problem, w, iterations, 6);
        EXPECT_LT(left, last) << iterations << " iterations, screening " << w;
        last = std::max(left, 1e-5);
      }
    }
}

TEST(Solve, KeepsTheInterpolatedValueAtCornersThatAreNoUnknowns) {
  Problem problem(7);
  const poisson::Solution solution = problem.solve({2, 7, false});  // an odd number ends in the other array
  int kept = 0;
  for (int d = 1; d <= 7; ++d) {
    const octree::LevelView& level = problem.tree.view.levels[d];
    const octree::LevelView& above = problem.tree.view.levels[d - 1];
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      if (test::is_unknown(level, n) || !test::in_cube(level, test::corner_at(level, n))) continue;
      ++kept;
      ASSERT_EQ(solution.u.data()[level.first_node + n],
                octree::prolonged(above, solution.u.data() + above.first_node, level.parent[n >> 3],
                                  static_cast<int>(n & 7)));
    }
  }
  EXPECT_GT(kept, 1000);
}

// Chebyshev polynomials on [lower, 1] stay below 1 on (0, lower) as well: no component of the error may grow. From 29
// iterations on the interval stays the same (solve.cpp) and more iterations must come closer.
TEST(Solve, ErrorNeverGrowsAndFallsWithManyIterations) {
  constexpr int kAdaptive = octree::kCompleteDepth + 1;
  Problem problem(kAdaptive);
  const octree::LevelView& level = problem.tree.view.finest();
  const octree::LevelView& above = problem.tree.view.levels[kAdaptive - 1];
  for (const double w : {0.0, 2.0}) {
    const auto system = test::assemble(level, problem.screening.view(kAdaptive), w);
    double last = 1e9;
    for (const int iterations : {1, 8, 16, 32, 64, 128}) {
      const poisson::Solution solution = problem.solve({w, iterations, false});
      Eigen::VectorXd start(level.nodes());
      for (std::int64_t n = 0; n < level.nodes(); ++n)
        start[n] = static_cast<double>(octree::prolonged(above, solution.u.data() + above.first_node,
                                                         level.parent[n >> 3], static_cast<int>(n & 7)));
      const Eigen::VectorXd direct = test::solve_directly(system, level_values(level, problem.b.data()), start);
      const double after = energy_error(level, system, level_values(level, solution.u.data()), direct);
      EXPECT_LT(after, energy_error(level, system, start, direct)) << iterations << " iterations, screening " << w;
      if (iterations < 32) continue;
      EXPECT_LT(after, last) << iterations << " iterations, screening " << w;
      last = after;
    }
    EXPECT_LT(last, 1e-2);
  }
}

// Below 29 iterations, more of them reach further down the spectrum (solve.hpp); from there on all residuals must fall.
TEST(Solve, ResidualsFallWithTheIterations) {
  Problem problem(7);
  for (const double w : {0.0, 2.0}) {
    double last = 1e9;
    for (const int iterations : {1, 8, 32, 48, 64, 96, 128}) {
      const auto levels = problem.solve({w, iterations, true}).levels;
      for (std::size_t d = octree::kCompleteDepth + 1; d < levels.size(); ++d) {
        EXPECT_EQ(levels[d].iterations, iterations);
        EXPECT_LT(levels[d].residual_after, levels[d].residual_before) << "level " << d << ", " << iterations;
      }
      const poisson::LevelSolve& first = levels[octree::kCompleteDepth + 1];
      if (iterations < 32) continue;
      EXPECT_LT(first.residual_after, last) << iterations << " iterations, screening " << w;
      last = first.residual_after;
    }
  }
}

TEST(Solve, IsOneInsideZeroOutsideAndHalfAtTheSamplesOfASphere) {
  for (const double w : {0.0, 2.0}) {
    Problem problem(6, 20'000);
    const poisson::Solution solution = problem.solve({w, 16, false});
    const double isovalue =
        poisson::mean_at_samples(problem.tree.ex, problem.tree.tree, solution.u.cview(), problem.tree.samples.view());
    const auto at = [&](const Vec3f& p) {
      return static_cast<double>(octree::value_at(problem.tree.view, solution.u.data(), p, problem.tree.view.depth));
    };
    const double centre = at({0.5F, 0.5F, 0.5F});
    const double outside = at({0.02F, 0.03F, 0.04F});
    EXPECT_NEAR(centre - outside, 1, 0.08) << "screening " << w;  // the jump across a surface of known area
    EXPECT_NEAR(isovalue - outside, 0.5, 0.08) << "screening " << w;
    if (w == 0) continue;
    EXPECT_NEAR(isovalue, 0.5, 0.02);  // screening fixes the constant, too
  }
}

// ---- A solution that is known:  u = cos(pi x) cos(pi y) cos(pi z) has no flux through the faces, -laplace u = 3 pi^2
// u.

double known(double x, double y, double z) {
  using std::numbers::pi;
  return std::cos(pi * x) * std::cos(pi * y) * std::cos(pi * z);
}

TEST(Solve, ConvergesToAKnownSolutionAtSecondOrder) {
  std::vector<double> worst;
  for (int depth = 2; depth <= 5; ++depth) {
    SmallTree tree = test::complete_tree(depth);
    ASSERT_EQ(tree.view.finest().cells(), std::int64_t{1} << 3 * depth);
    const exec::Buffer<float> b = test::right_side(tree, known);
    const poisson::Solution solution = poisson::solve_poisson(tree.ex, tree.view, b.cview(), {}, {0, 300, false});
    const octree::LevelView& level = tree.view.finest();
    const std::vector<double> errors = test::errors_of(level, solution.u.data() + level.first_node, known);
    double mean = 0;  // which the natural boundary leaves open
    for (const double e : errors) mean += e / static_cast<double>(errors.size());
    worst.push_back(0);
    for (const double e : errors) worst.back() = std::max(worst.back(), std::abs(e - mean));
  }
  test::expect_second_order(worst);
}

TEST(Solve, IsZeroForAZeroRightHandSideWithoutScreening) {
  Problem problem(6, 100);
  exec::fill(problem.tree.ex, problem.b.view(), 0.0F);
  const poisson::Solution solution = problem.solve({0, 8, true});
  for (std::int64_t n = 0; n < solution.u.size(); ++n) ASSERT_EQ(solution.u.data()[n], 0.0F);
  for (const poisson::LevelSolve& level : solution.levels) EXPECT_EQ(level.residual_after, 0);
}

TEST(Solve, IsOneHalfForAZeroRightHandSideWithScreening) {
  Problem problem(6, 100);
  exec::fill(problem.tree.ex, problem.b.view(), 0.0F);
  const poisson::Solution solution = problem.solve({4, 400, false});
  for (int d = octree::kCompleteDepth; d <= 6; ++d) {
    const octree::LevelView& level = problem.tree.view.levels[d];
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      if (!test::in_cube(level, test::corner_at(level, n))) continue;
      ASSERT_NEAR(solution.u.data()[level.first_node + n], 0.5, 0.02) << "level " << d;
    }
  }
}

}  // namespace
}  // namespace pointskin
