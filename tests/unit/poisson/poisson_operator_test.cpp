// The matrix-free operator, turned into a matrix by applying it to unit vectors.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "poisson/operator.hpp"
#include "unit/poisson/reference_system.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

/// The operator's rows of the unknowns over all nodes of a level, its bounding diagonal there, and its residual of
/// zero.
struct Assembled {
  Eigen::MatrixXd rows;  ///< (unknowns, nodes)
  Eigen::VectorXd diagonal;
  Eigen::VectorXd pull;
  std::vector<std::int64_t> unknowns;

  [[nodiscard]] Eigen::MatrixXd square() const {
    Eigen::MatrixXd a(rows.rows(), rows.rows());
    for (Eigen::Index c = 0; c < a.cols(); ++c) a.col(c) = rows.col(unknowns[static_cast<std::size_t>(c)]);
    return a;
  }
};

/// The matrix's column of node n: minus the change of the residual, in the bricks around n.
void add_column(const poisson::LevelSystem& system, std::int64_t n, std::vector<float>& u,
                const std::vector<Eigen::Index>& row_of, Assembled& out) {
  u[static_cast<std::size_t>(n)] = 1;
  for (int j = 0; j < octree::kNeighbours; ++j) {
    const std::int32_t brick = system.level.neighbours[(n >> 3) * octree::kNeighbours + j];
    if (brick < 0) continue;
    const auto r = poisson::brick_residual(system, brick, octree::load_neighbourhood(system.level, brick, u.data()));
    for (int s = 0; s < 8; ++s) {
      const Eigen::Index row = row_of[static_cast<std::size_t>(8 * std::int64_t{brick} + s)];
      if (row >= 0) out.rows(row, n) = out.pull[row] - static_cast<double>(r.corner[s].residual);
    }
  }
  u[static_cast<std::size_t>(n)] = 0;
}

Assembled assemble_by_unit_vectors(const poisson::LevelSystem& system) {
  const std::int64_t nodes = system.level.nodes();
  Assembled out;
  std::vector<Eigen::Index> row_of(static_cast<std::size_t>(nodes), -1);
  for (std::int64_t n = 0; n < nodes; ++n) {
    if (!test::is_unknown(system.level, n)) continue;
    row_of[static_cast<std::size_t>(n)] = static_cast<Eigen::Index>(out.unknowns.size());
    out.unknowns.push_back(n);
  }
  const auto count = static_cast<Eigen::Index>(out.unknowns.size());
  out.rows = Eigen::MatrixXd::Zero(count, nodes);
  out.diagonal.resize(count);
  out.pull.resize(count);
  std::vector<float> u(static_cast<std::size_t>(nodes), 0);
  for (std::int32_t brick = 0; brick < system.level.bricks; ++brick) {
    const auto r = poisson::brick_residual(system, brick, octree::load_neighbourhood(system.level, brick, u.data()));
    for (int s = 0; s < 8; ++s) {
      const Eigen::Index row = row_of[static_cast<std::size_t>(8 * std::int64_t{brick} + s)];
      if (row < 0) continue;
      out.diagonal[row] = r.corner[s].diagonal;
      out.pull[row] = r.corner[s].residual;
    }
  }
  for (std::int64_t n = 0; n < nodes; ++n) add_column(system, n, u, row_of, out);
  return out;
}

/// Applies `check` to the operator of a complete level with the cube's faces and of an adaptive one, without and with
/// screening.
template <class Check>
void for_all_systems(const Check& check) {
  for (const int level_depth : {0, 1, 2, 3, 6})
    for (const double screening : {0.0, 2.0, 50.0}) {
      test::Random random(17);
      SmallTree tree(level_depth == 6 ? test::clustered_points(random, 2, 4, 0.02)
                                      : test::clustered_points(random, 30, 3, 0.05, 0, 0.9999999),
                     {}, level_depth);
      tree.weigh(0.7F, level_depth);
      const poisson::Screening collapsed = poisson::collapse_samples(tree.ex, tree.tree, tree.samples.view());
      const octree::LevelView& level = tree.view.finest();
      const std::vector<float> b(static_cast<std::size_t>(level.nodes()), 0.0F);
      const poisson::LevelSystem system{level, b.data(), collapsed.view(level_depth), static_cast<float>(screening),
                                        poisson::make_axis_rows_f()};
      SCOPED_TRACE("level " + std::to_string(level_depth) + ", screening " + std::to_string(screening));
      check(assemble_by_unit_vectors(system), system, tree);
    }
}

TEST(Operator, EqualsTheMatrixAssembledCellByCell) {
  for_all_systems([](const Assembled& a, const poisson::LevelSystem& system, SmallTree&) {
    const auto reference = test::assemble(system.level, system.screening, system.screening_scale);
    ASSERT_EQ(a.unknowns, reference.unknowns);
    const Eigen::MatrixXd dense(reference.matrix);
    const double tolerance = 1e-5 * (4 + dense.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < a.unknowns.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      ASSERT_LT((a.rows.row(row) - dense.row(a.unknowns[i])).cwiseAbs().maxCoeff(), tolerance);
      ASSERT_NEAR(a.pull[row], reference.pull[a.unknowns[i]], tolerance);
    }
  });
}

TEST(Operator, OfOneCornerHasTheBitsOfItsBrick) {
  for_all_systems([](const Assembled&, const poisson::LevelSystem& system, SmallTree&) {
    test::Random random(31);
    std::vector<float> u(static_cast<std::size_t>(system.level.nodes()));
    for (float& value : u) value = static_cast<float>(random.in(-1, 1));
    for (std::int32_t brick = 0; brick < system.level.bricks; ++brick) {
      const auto r = poisson::brick_residual(system, brick, octree::load_neighbourhood(system.level, brick, u.data()));
      for (int s = 0; s < 8; ++s) {
        const std::int64_t node = 8 * std::int64_t{brick} + s;
        if (!test::is_unknown(system.level, node)) continue;
        float value = 0;
        const poisson::CornerResidual one = poisson::CornerOperator(system, node).residual(u.data(), value);
        ASSERT_EQ(value, u[static_cast<std::size_t>(node)]);
        ASSERT_EQ(one.residual, r.corner[s].residual) << "node " << node;
        ASSERT_EQ(one.diagonal, r.corner[s].diagonal) << "node " << node;
      }
    }
  });
}

TEST(Operator, IsSymmetric) {
  for_all_systems([](const Assembled& a, const poisson::LevelSystem&, SmallTree&) {
    const Eigen::MatrixXd square = a.square();
    ASSERT_LT((square - square.transpose()).cwiseAbs().maxCoeff(), 1e-5 * square.cwiseAbs().maxCoeff());
  });
}

TEST(Operator, IsPositiveSemidefiniteAndDefiniteWithScreening) {
  for_all_systems([](const Assembled& a, const poisson::LevelSystem& system, SmallTree&) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a.square(), Eigen::EigenvaluesOnly);
    const double smallest = solver.eigenvalues().minCoeff();
    const double rounding = 1e-6 * solver.eigenvalues().maxCoeff();
    ASSERT_GT(smallest, -rounding);
    if (system.screening_scale > 0 || system.level.depth == 6) {  // fixed values around, or pulls, leave no null space
      ASSERT_GT(smallest, rounding);
    }
  });
}

TEST(Operator, IsBoundedByItsDiagonal) {
  for_all_systems([](const Assembled& a, const poisson::LevelSystem&, SmallTree&) {
    const Eigen::VectorXd scale = a.diagonal.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * a.square() * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
    ASSERT_GT(solver.eigenvalues().minCoeff(), -1e-6);
    ASSERT_LT(solver.eigenvalues().maxCoeff(), 1 + 1e-6);
  });
}

TEST(Operator,
     LeavesTheConstantOneHalfWithoutResidual) {  // the screening's target: the Laplacian of a constant is zero
  for_all_systems([](const Assembled& a, const poisson::LevelSystem& system, SmallTree&) {
    const std::vector<float> half(static_cast<std::size_t>(system.level.nodes()), 0.5F);
    const double tolerance = 1e-6 * (1 + a.diagonal.maxCoeff());
    for (std::int32_t brick = 0; brick < system.level.bricks; ++brick) {
      const auto r =
          poisson::brick_residual(system, brick, octree::load_neighbourhood(system.level, brick, half.data()));
      for (int s = 0; s < 8; ++s) {
        if (!test::is_unknown(system.level, 8 * std::int64_t{brick} + s)) continue;
        ASSERT_NEAR(r.corner[s].residual, 0, tolerance);
      }
    }
  });
}

TEST(Operator, AnnihilatesLinearFunctionsAwayFromTheCubesFaces) {
  test::Random random(23);
  SmallTree tree(test::clustered_points(random, 3, 4, 0.02, 0.2, 0.8), {}, 6);
  const octree::LevelView& level = tree.view.finest();
  const std::vector<float> b(static_cast<std::size_t>(level.nodes()), 0.0F);
  std::vector<float> u(b.size());
  for (std::int64_t n = 0; n < level.nodes(); ++n) {
    const octree::Coordinates c = test::corner_at(level, n);
    u[static_cast<std::size_t>(n)] = static_cast<float>(3 * c.x - 2 * c.y + c.z - 7) / 64;  // exact
  }
  const poisson::LevelSystem system{level, b.data(), {}, 0, poisson::make_axis_rows_f()};
  int tested = 0;
  for (std::int32_t brick = 0; brick < level.bricks; ++brick) {
    const auto r = poisson::brick_residual(system, brick, octree::load_neighbourhood(level, brick, u.data()));
    for (int s = 0; s < 8; ++s) {
      if (!test::is_unknown(level, 8 * std::int64_t{brick} + s)) continue;
      ++tested;
      ASSERT_NEAR(r.corner[s].residual, 0, 2e-6);
    }
  }
  EXPECT_GT(tested, 100);
}

TEST(Operator, MeasuresTheDirichletEnergyPlusTheWeightedSquaresAtTheSamples) {
  for_all_systems([](const Assembled& a, const poisson::LevelSystem& system, SmallTree& tree) {
    test::Random random(29);
    Eigen::VectorXd x(static_cast<Eigen::Index>(a.unknowns.size()));
    std::vector<float> u(static_cast<std::size_t>(system.level.nodes()), 0.0F);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      u[static_cast<std::size_t>(a.unknowns[static_cast<std::size_t>(i)])] = static_cast<float>(random.in(-1, 1));
      x[i] = u[static_cast<std::size_t>(a.unknowns[static_cast<std::size_t>(i)])];
    }
    double energy = 0;
    for (std::int64_t cell = 0; cell < system.level.cells(); ++cell) {
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
          energy += test::element_stiffness(i, j) *
                    u[static_cast<std::size_t>(test::corner_of(system.level, cell, i))] *
                    u[static_cast<std::size_t>(test::corner_of(system.level, cell, j))];
      const std::int32_t place = system.screening.brick_index[cell >> 3];
      if (place < 0 || system.screening_scale == 0) continue;
      const poisson::CollapsedSample& s = system.screening.samples[8 * std::int64_t{place} + (cell & 7)];
      if (!(s.weight > 0)) continue;
      const double value =
          octree::interpolated(system.level, u.data(), static_cast<std::int32_t>(cell), {s.x, s.y, s.z});
      energy += system.screening_scale * s.weight * value * value;
    }
    EXPECT_NEAR(x.dot(a.square() * x), energy, 1e-4 * energy) << tree.view.depth;
  });
}

}  // namespace
}  // namespace pointskin
