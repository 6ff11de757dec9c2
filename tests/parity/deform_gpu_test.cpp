// Deformed clouds and their meshes on the GPU against the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/deform.hpp>
#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include <optional>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/deformations.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::same_bytes;

class DeformOnGpu : public test::GpuTest {
 protected:
  void expect_parity(const Cloud& cloud, const Deformation& deformation, const Options& options) {
    Deformer on_cpu(cloud, options, Device::cpu());
    Deformer on_gpu(cloud, options, gpu_);
    for (const double share : {0.0, 0.3, 1.0}) {
      SCOPED_TRACE(share);
      on_cpu.deform(scaled(deformation, share));
      on_gpu.deform(scaled(deformation, share));
      const Cloud expected = on_cpu.cloud();
      const Cloud got = on_gpu.cloud();
      EXPECT_TRUE(same_bytes(got.positions, expected.positions));
      EXPECT_TRUE(same_bytes(got.normals, expected.normals));
      EXPECT_EQ(on_gpu.report().inserted, on_cpu.report().inserted);
      EXPECT_EQ(on_gpu.report().thinned, on_cpu.report().thinned);
      EXPECT_EQ(on_gpu.spacing().median, on_cpu.spacing().median);
      expect_same_bytes(on_gpu.reconstruct(), on_cpu.reconstruct());
    }
  }
};

Options shallow(int depth) {
  Options options;
  options.depth = depth;
  return options;
}

TEST_F(DeformOnGpu, GivesTheBytesOfTheCpuForAllRegionsTransformsAndLattices) {
  Deformation deformation = test::twist_and_pull();
  deformation.handles.push_back({PointSet{{5, 6, 7}}, RigidMotion{.axis = {0, 1, 0}, .angle = 40}});
  Cloud cloud = test::torus_cloud(30000, 3);
  cloud.attributes = {
      test::attribute_of<float>("height", cloud.positions, [](const Vec3f& p) { return p.z; }),
      test::attribute_of<double>("gps_time", cloud.positions, [](const Vec3f& p) { return 4e8 + p.x; }),
      test::attribute_of<std::int32_t>("label", cloud.positions, [](const Vec3f& p) { return 1e9 * p.y; })};
  Options options = shallow(7);
  options.attributes = true;
  expect_parity(cloud, deformation, options);
}

TEST_F(DeformOnGpu, GivesTheBytesOfTheCpuForABend) {
  expect_parity(test::box_cloud(50000, 4), test::bend_along_x(2), shallow(6));
}

TEST_F(DeformOnGpu, GivesTheBytesOfTheCpuForAScan) {
  const std::optional<Cloud> bunny = test::shared_cloud("bunny_scans");
  if (!bunny) GTEST_SKIP() << "no bunny_scans";
  expect_parity(*bunny, test::bend_upright(*bunny), shallow(8));
}

}  // namespace
}  // namespace pointskin
