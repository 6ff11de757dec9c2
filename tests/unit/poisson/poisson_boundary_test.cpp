// Dirichlet conditions: what is held is 0, and the rest is solved as a direct solver would.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "poisson/boundary.hpp"
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

/// Samples of a surface, ready to be solved.
struct Problem {
  template <class MakeTree>
  explicit Problem(const MakeTree& make_tree) : tree(make_tree()) {
    poisson::weigh_samples(tree.ex, tree.tree, {1.5, false}, tree.samples);
    poisson::find_resolution(tree.ex, tree.tree, tree.samples);  // for the splat depths: all cells count here
    b = poisson::splat_divergence(tree.ex, tree.tree, tree.samples.view(), {});
    screening = poisson::collapse_samples(tree.ex, tree.tree, tree.samples.view());
  }
  poisson::Solution solve(poisson::SolveOptions options, const exec::Buffer<std::uint8_t>& free) {
    options.free_unknowns = free.cview();
    return poisson::solve_poisson(tree.ex, tree.view, b.cview(), screening, options);
  }

  SmallTree tree;
  exec::Buffer<float> b;
  poisson::Screening screening;
};

bool on_face(const octree::LevelView& level, const octree::Coordinates& c) {
  const std::int32_t last = 1 << level.depth;
  return c.x == 0 || c.y == 0 || c.z == 0 || c.x == last || c.y == last || c.z == last;
}

/// A plane of samples through the whole cube: free, its surface would run into the faces.
std::vector<Vec3f> plane_points(std::int64_t n, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Vec3f> points;
  for (std::int64_t i = 0; i < n; ++i)
    points.push_back({static_cast<float>(random.unit()), static_cast<float>(random.unit()), 0.45F});
  return points;
}
SmallTree plane_tree(int depth) {
  const std::vector<Vec3f> points = plane_points(3000, 3);
  return {points, std::vector<Vec3f>(points.size(), Vec3f{0, 0, 1}), depth};
}

TEST(Boundary, LeavesTheUnknownsOfTheFacesOutAndNoOthers) {
  SmallTree tree = plane_tree(6);
  const auto all = poisson::free_unknowns(tree.ex, tree.view, false);
  const auto inner = poisson::free_unknowns(tree.ex, tree.view, true);
  ASSERT_EQ(inner.size(), tree.view.nodes / 8);
  std::int64_t held = 0;
  for (int d = 0; d <= 6; ++d) {
    const octree::LevelView& level = tree.view.levels[d];
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const bool unknown = (level.unknowns[n >> 3] >> (n & 7) & 1) != 0;
      const std::int64_t brick = (level.first_node + n) / 8;
      ASSERT_EQ((all.data()[brick] >> (n & 7) & 1) != 0, unknown);
      ASSERT_EQ((inner.data()[brick] >> (n & 7) & 1) != 0, unknown && !on_face(level, test::corner_at(level, n)));
      if (unknown && on_face(level, test::corner_at(level, n))) ++held;
    }
  }
  EXPECT_GT(held, 8 + 26 + 98);  // all corners of levels 0 to 2 but 1 + 27
}

TEST(Boundary, IsExactlyZeroOnTheFacesOfEveryLevel) {
  Problem problem([] { return plane_tree(7); });
  const auto free = poisson::free_unknowns(problem.tree.ex, problem.tree.view, true);
  const poisson::Solution solution = problem.solve({2, 7, false}, free);
  double largest = 0;
  for (int d = 0; d <= 7; ++d) {
    const octree::LevelView& level = problem.tree.view.levels[d];
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      const octree::Coordinates c = test::corner_at(level, n);
      if (!test::in_cube(level, c)) continue;
      const float u = solution.u.data()[level.first_node + n];
      if (on_face(level, c)) {
        ASSERT_EQ(u, 0) << "level " << d;
      }
      if (d == 7) largest = std::max(largest, static_cast<double>(u));
    }
  }
  EXPECT_GT(largest, 0.5);
}

TEST(Boundary, EqualsTheDirectSolutionWithZeroOnTheFaces) {
  Problem problem([] { return plane_tree(6); });
  const auto free = poisson::free_unknowns(problem.tree.ex, problem.tree.view, true);
  const double w = 4;
  const poisson::Solution solution = problem.solve({w, 1000, true}, free);
  for (int d = octree::kCompleteDepth; d <= 6; ++d) {  // coarser levels are starting values
    octree::LevelView level = problem.tree.view.levels[d];
    level.unknowns = free.data() + level.first_node / 8;  // of the reference, too
    const auto system = test::assemble(level, problem.screening.view(d), std::ldexp(w, 2 * (d - 6)));
    const auto nodes = static_cast<Eigen::Index>(level.nodes());
    Eigen::VectorXd u(nodes), b(nodes);
    for (Eigen::Index n = 0; n < nodes; ++n) {
      u[n] = static_cast<double>(solution.u.data()[level.first_node + n]);
      b[n] = static_cast<double>(problem.b.data()[level.first_node + n]);
    }
    EXPECT_EQ(solution.levels[static_cast<std::size_t>(d)].unknowns, static_cast<std::int64_t>(system.unknowns.size()));
    if (system.unknowns.empty()) continue;  // level 0
    const Eigen::VectorXd direct = test::solve_directly(system, b, u);
    double worst = 0;
    for (const std::int64_t n : system.unknowns) worst = std::max(worst, std::abs(u[n] - direct[n]));
    EXPECT_LT(worst, 1e-3) << "level " << d;
  }
}

TEST(Boundary, HeldCornersInsideOfTheCubeStayZeroAndOthersKeepWhatWasInterpolated) {
  Problem problem([] { return test::sphere_tree(2000, 0.3, 6); });
  auto free = poisson::free_unknowns(problem.tree.ex, problem.tree.view, false);
  test::Random random(5);
  for (std::int64_t b = 0; b < free.size(); ++b) free.data()[b] &= static_cast<std::uint8_t>(random.below(256));
  const poisson::Solution solution = problem.solve({2, 8, false}, free);
  int held = 0, kept = 0;
  for (int d = 1; d <= 6; ++d) {
    const octree::LevelView& level = problem.tree.view.levels[d];
    const octree::LevelView& above = problem.tree.view.levels[d - 1];
    const float* u = solution.u.data();
    for (std::int64_t n = 0; n < level.nodes(); ++n) {
      if (!test::in_cube(level, test::corner_at(level, n))) continue;
      if (test::is_unknown(level, n)) {
        if ((free.data()[(level.first_node + n) / 8] >> (n & 7) & 1) != 0) continue;
        ++held;
        ASSERT_EQ(u[level.first_node + n], 0);
      } else {
        ++kept;
        ASSERT_EQ(u[level.first_node + n],
                  octree::prolonged(above, u + above.first_node, level.parent[n >> 3], static_cast<int>(n & 7)));
      }
    }
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(kept, 1000);
}

// u = sin(pi x) sin(pi y) sin(pi z) is 0 on the faces, -laplace u = 3 pi^2 u.
double known(double x, double y, double z) {
  using std::numbers::pi;
  return std::sin(pi * x) * std::sin(pi * y) * std::sin(pi * z);
}

TEST(Boundary, ConvergesToAKnownSolutionAtSecondOrder) {
  std::vector<double> worst;
  for (int depth = 2; depth <= 5; ++depth) {
    SmallTree tree = test::complete_tree(depth);
    const exec::Buffer<float> b = test::right_side(tree, known);
    const auto free = poisson::free_unknowns(tree.ex, tree.view, true);
    const poisson::Solution solution =
        poisson::solve_poisson(tree.ex, tree.view, b.cview(), {}, {0, 300, false, {}, free.cview()});
    const octree::LevelView& level = tree.view.finest();
    worst.push_back(0);
    for (const double e : test::errors_of(level, solution.u.data() + level.first_node, known))
      worst.back() = std::max(worst.back(), std::abs(e));
  }
  test::expect_second_order(worst);
}

}  // namespace
}  // namespace pointskin
