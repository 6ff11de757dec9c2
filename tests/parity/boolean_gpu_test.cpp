// Set operations on the GPU against the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/boolean.hpp>
#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

class BooleansOnGpu : public test::GpuTest, public testing::WithParamInterface<int> {
 protected:
  void expect_parity(const BooleanOperand& a, const BooleanOperand& b, const BooleanOptions& options) {
    const auto op = static_cast<BooleanOp>(GetParam());
    const BooleanResult expected = Booleans(Device::cpu()).combine(a, b, op, options);
    const BooleanResult result = Booleans(gpu_).combine(a, b, op, options);
    test::expect_same_bytes(result.mesh, expected.mesh);
    EXPECT_TRUE(test::same_bytes(result.cloud.positions, expected.cloud.positions));
    EXPECT_TRUE(test::same_bytes(result.cloud.normals, expected.cloud.normals));
    EXPECT_EQ(result.report.curve_length, expected.report.curve_length);
    EXPECT_EQ(result.report.added, expected.report.added);
    EXPECT_EQ(result.report.a.coincident, expected.report.a.coincident);
    EXPECT_EQ(result.report.b.coincident, expected.report.b.coincident);
  }
};

TEST_P(BooleansOnGpu, OfCloudsGiveTheSameBytesAsOnTheCpu) {
  const Cloud a = test::sphere_cloud(20'000, 1);
  Cloud b = test::torus_cloud(20'000, 2, 1, 0.3, {0.4, 0.1, 0});
  b.origin = {0.25, 0, -0.5};
  for (const Creases creases : {Creases::none, Creases::sampled})
    for (const int depth : {5, 7}) {
      BooleanOptions options;
      options.reconstruction.depth = depth;
      options.creases = creases;
      expect_parity(a, b, options);
    }
}

TEST_P(BooleansOnGpu, OfNoisyCoincidentCloudsAndAMeshGiveTheSameBytesAsOnTheCpu) {
  BooleanOptions options;
  options.reconstruction.depth = 6;
  const Cloud noisy = test::jittered(test::box_cloud(20'000, 3), 4, 0.02);
  expect_parity(noisy, test::box_mesh({-1, -1, -1}, {1, 1, 0}), options);  // five faces in common planes
}

INSTANTIATE_TEST_SUITE_P(EveryOperation, BooleansOnGpu, testing::Range(0, 4));

}  // namespace
}  // namespace pointskin
