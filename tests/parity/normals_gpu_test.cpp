// Normals made on the GPU against the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/normals.hpp>

#include <cstdint>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

class NormalsOnGpu : public test::GpuTest {
 protected:
  void expect_parity(const Cloud& cloud, NormalOptions options) {
    options.curvature = true;
    Cloud expected = cloud;
    NormalEstimator on_cpu(Device::cpu());
    on_cpu.orient(expected, options);
    Cloud result = cloud;
    NormalEstimator on_gpu(gpu_);
    on_gpu.orient(result, options);
    EXPECT_TRUE(test::same_bytes(result.normals, expected.normals));
    ASSERT_EQ(result.attributes.size(), expected.attributes.size());
    for (std::size_t a = 0; a < result.attributes.size(); ++a)
      EXPECT_TRUE(test::same_bytes(result.attributes[a].values, expected.attributes[a].values))
          << expected.attributes[a].name;
    EXPECT_EQ(on_gpu.report().patches, on_cpu.report().patches);
    EXPECT_EQ(on_gpu.report().components, on_cpu.report().components);
    EXPECT_EQ(on_gpu.report().rounds, on_cpu.report().rounds);
    EXPECT_EQ(on_gpu.report().enclosing, on_cpu.report().enclosing);
    EXPECT_EQ(on_gpu.report().flipped, on_cpu.report().flipped);
  }
  static Cloud without_normals(Cloud cloud) {
    cloud.normals.clear();
    return cloud;
  }
  static Cloud partly_flipped(Cloud cloud) {
    test::Random random(1);
    for (Vec3f& n : cloud.normals)
      if (random.unit() < 0.3) n = {-n.x, -n.y, -n.z};
    return cloud;
  }
};

TEST_F(NormalsOnGpu, OfShapesAreTheSameBytesAsOnTheCpu) {
  for (const Cloud& cloud :
       {test::sphere_cloud(500, 2), test::linked_tori_cloud(30'000, 3), test::box_cloud(20'000, 4),
        test::thin_plate_cloud(40'000, 5, 0.02), test::jittered(test::torus_cloud(30'000, 6), 7, 0.03)}) {
    expect_parity(without_normals(cloud), {});
    expect_parity(partly_flipped(cloud), {});
  }
}

TEST_F(NormalsOnGpu, OfEveryMethodAreTheSameBytesAsOnTheCpu) {
  const Cloud cloud = without_normals(test::linked_tori_cloud(20'000, 8));
  NormalOptions options;
  options.sensors = {{3, 1, 2}, {-3, 0, 0}};
  expect_parity(cloud, options);
  options = {};
  options.method = NormalMethod::iterate;
  options.random_start = true;
  expect_parity(cloud, options);
}

TEST_F(NormalsOnGpu, OfAScanAreTheSameBytesAsOnTheCpu) {
  const auto cloud = test::shared_cloud("armadillo_oriented");
  if (!cloud) GTEST_SKIP() << "the scans of ../shared/data are not here";
  expect_parity(without_normals(*cloud), {});
}

}  // namespace
}  // namespace pointskin
