#include "unit/fluid/particle_tree_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnCpu, ParticleTreeOn, CpuSpaces);

namespace {

TEST(CellGrid, HasCellsAsWideAsTheRadiusOrALittleWider) {
  for (const double side : {0.0, 0.5, 1.0, 7.9, 8.0, 8.1, 1000.0}) {
    const fluid::CellGrid grid = fluid::grid_around({{1, 2, 3}, {1 + static_cast<float>(side), 2, 3}}, 1);
    const double width = grid.cube.size / std::ldexp(1.0, grid.depth);
    EXPECT_GE(width, 1) << side;
    EXPECT_LE(width, 1.001) << side;
    EXPECT_GE(grid.cube.size, side);
    EXPECT_TRUE(grid.depth == 1 || grid.cube.size / 2 <= 1.001 * side) << side;
  }
}

TEST(CellGrid, WidensItsCellsWhereLevelsDoNotReach) {
  const fluid::CellGrid grid = fluid::grid_around({{0, 0, 0}, {1e9F, 0, 0}}, 1);
  EXPECT_EQ(grid.depth, octree::kMaxDepth);
  EXPECT_GE(grid.cube.size, 1e9);
}

}  // namespace
}  // namespace pointskin::test
