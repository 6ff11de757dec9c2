// The octree on the GPU: the tests of all spaces, and every array against that of the CPU, entry by entry.
#include "unit/octree/octree_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnGpu, OctreeOn, CudaSpaces);

namespace {

class OctreeParity : public OnSpace<exec::Cuda> {
 protected:
  exec::Cpu cpu_{2};
};

void expect_equal_levels(const octree::HostLevel& gpu, const octree::HostLevel& cpu) {
  EXPECT_EQ(gpu.cell_bricks, cpu.cell_bricks);
  EXPECT_EQ(gpu.bricks, cpu.bricks);
  EXPECT_TRUE(gpu.brick_key == cpu.brick_key);
  EXPECT_TRUE(gpu.parent == cpu.parent);
  EXPECT_TRUE(gpu.neighbours == cpu.neighbours);
  EXPECT_TRUE(gpu.child_brick == cpu.child_brick);
  EXPECT_TRUE(gpu.unknowns == cpu.unknowns);
  EXPECT_TRUE(gpu.point_begin == cpu.point_begin);
}

void expect_equal_octrees(exec::Cuda& gpu, exec::Cpu& cpu, const std::vector<Vec3f>& points, int depth) {
  const BuiltOctree on_gpu = build(gpu, points, depth);
  const BuiltOctree on_cpu = build(cpu, points, depth);
  expect_same(on_gpu.keys, on_cpu.keys);
  ASSERT_EQ(on_gpu.host.levels.size(), on_cpu.host.levels.size());
  for (std::size_t d = 0; d < on_cpu.host.levels.size(); ++d) {
    SCOPED_TRACE(::testing::Message() << "level " << d);
    expect_equal_levels(on_gpu.host.levels[d], on_cpu.host.levels[d]);
  }
}

/// A wavy sheet of n points: every level has surface cells, padding and ghosts.
std::vector<Vec3f> sheet(int n) {
  Random random(kSeed);
  return generate(n, [&] {
    const double x = random.in(0.1, 0.9);
    const double y = random.in(0.1, 0.9);
    return Vec3f{static_cast<float>(x), static_cast<float>(y), static_cast<float>(0.5 + 0.2 * std::sin(7 * x + 3 * y))};
  });
}

/// A test of its own for each cloud, so that slow checkers can run many at once.
class OctreeParityOfCloud : public OctreeParity, public testing::WithParamInterface<std::size_t> {};

TEST_P(OctreeParityOfCloud, ArraysEqualThoseOfTheCpu) {
  const TestCloud cloud = all_clouds(kSeed)[GetParam()];
  for (const int depth : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', depth " << depth << ", seed " << kSeed);
    expect_equal_octrees(space(), cpu_, cloud.points, depth);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryCloud, OctreeParityOfCloud, testing::Range(std::size_t{0}, all_clouds(kSeed).size()));

TEST_F(OctreeParity, ArraysOfFewPointsAtDepth20EqualThoseOfTheCpu) {
  for (const TestCloud& cloud : sparse_clouds(kSeed)) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', seed " << kSeed);
    expect_equal_octrees(space(), cpu_, cloud.points, 20);
  }
}

TEST_F(OctreeParity, ArraysOfALargeCloudEqualThoseOfTheCpu) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  expect_equal_octrees(space(), cpu_, sheet(200'000), 9);
}

TEST_F(OctreeParity, PointsAreSortedAsOnTheCpu) {
  std::vector<TestCloud> clouds = all_clouds(kSeed);
  clouds.push_back({"sheet", sheet(200'000)});
  for (const TestCloud& cloud : clouds) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', seed " << kSeed);
    std::vector<std::uint64_t> ties;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) ties.push_back(hash(i / 2));  // some agree
    const octree::SortedPoints on_gpu = sort_cloud(space(), cloud.points, ties);
    const octree::SortedPoints on_cpu = sort_cloud(cpu_, cloud.points, ties);
    expect_same(to_host(space(), on_gpu.keys), to_host(cpu_, on_cpu.keys));
    expect_same(to_host(space(), on_gpu.order), to_host(cpu_, on_cpu.order));
  }
}

}  // namespace
}  // namespace pointskin::test
