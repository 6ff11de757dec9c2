// Surfaces of particles on the GPU against the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/error.hpp>
#include <pointskin/fluid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/particles.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;

class FluidOnGpu : public test::GpuTest {
 protected:
  void expect_parity(const Cloud& cloud, const FluidOptions& options) {
    FluidSurfacer on_cpu(Device::cpu());
    FluidSurfacer on_gpu(gpu_);
    Mesh expected;
    try {
      expected = on_cpu.surface(cloud, options);
    } catch (const Error& error) {
      EXPECT_EQ(test::error_of([&] { on_gpu.surface(cloud, options); }), error.code());
      return;
    }
    for (int run = 0; run < 2; ++run) expect_same_bytes(on_gpu.surface(cloud, options), expected);
    EXPECT_EQ(on_gpu.report().coarse_corners, on_cpu.report().coarse_corners);
    EXPECT_EQ(on_gpu.report().fine_corners, on_cpu.report().fine_corners);
    EXPECT_EQ(on_gpu.report().rounds, on_cpu.report().rounds);
    EXPECT_EQ(on_gpu.report().removed_components, on_cpu.report().removed_components);
  }
};

constexpr std::uint64_t kSeed = 7;

/// A test of its own for each frame and kernel, so that slow checkers can run many at once.
class FluidFrameOnGpu : public FluidOnGpu, public testing::WithParamInterface<std::tuple<std::size_t, FluidKernel>> {};

TEST_P(FluidFrameOnGpu, GivesTheBytesOfTheCpuForAllOptions) {
  const auto& [number, kernel] = GetParam();
  test::NamedParticles frame = std::move(test::particle_frames(kSeed)[number]);
  const std::vector<Vec3f>& at = frame.cloud.positions;
  frame.cloud.attributes = {
      test::attribute_of<float>("vx", at, [](const Vec3f& p) { return p.x * p.y; }),
      test::attribute_of<std::uint8_t>("red", at, [](const Vec3f& p) { return p.z > 0 ? 200 : 20; }),
      test::attribute_of<double>("time", at, [](const Vec3f& p) { return 4e8 + p.x; }),
      test::attribute_of<std::int32_t>("id", at, [](const Vec3f& p) { return 1e6 * p.x + 1e3 * p.y; }),
      test::attribute_of<std::uint8_t>("phase", at, [](const Vec3f& p) { return p.z > 0 ? 1 : 0; }),
      test::attribute_of<std::int16_t>("part", at, [](const Vec3f& p) { return 100 * p.z; })};
  for (std::size_t i = 0; i < at.size(); i += 3) frame.cloud.attributes.back().values.set_missing(i);
  for (const double cube_size : {0.5, 1.0, 1.7})
    for (const int smoothing : {0, 7}) {
      SCOPED_TRACE(::testing::Message() << frame.name << ", cube size " << cube_size);
      FluidOptions options;
      options.particle_radius = 1;
      options.kernel = kernel;
      options.cube_size = cube_size;
      options.smoothing_iterations = smoothing;
      options.min_component = smoothing > 0 ? 3 : 0;
      expect_parity(frame.cloud, options);
    }
}

INSTANTIATE_TEST_SUITE_P(EveryFrameAndKernel, FluidFrameOnGpu,
                         testing::Combine(testing::Range(std::size_t{0}, test::particle_frames(kSeed).size()),
                                          testing::Values(FluidKernel::isotropic, FluidKernel::anisotropic)));

TEST_F(FluidOnGpu, GivesTheBytesOfTheCpuBeyondTheRadiusOfParticles) {
  FluidOptions options;
  options.particle_radius = 1;
  options.cube_size = 4;
  options.smoothing_length = 1;
  for (int i = 0; i < 8; ++i) {
    Cloud cloud;
    cloud.positions = {{0.13F * i, 0.31F * i, 0.07F * i * i}, {40, 0, 0}};
    cloud.attributes = {{"heat", std::vector<float>{3, 7}}, {"id", std::vector<std::int32_t>{11, 12}}};
    options.smoothing_iterations = i % 2 * 5;
    SCOPED_TRACE(i);
    expect_parity(cloud, options);
  }
}

TEST_F(FluidOnGpu, GivesTheBytesOfTheCpuForASimulatedFrame) {
  const std::optional<Cloud> frame = test::shared_cloud("fluid_dam_break_24389");
  if (!frame) GTEST_SKIP() << "no fluid_dam_break_24389";
  for (const FluidKernel kernel : {FluidKernel::isotropic, FluidKernel::anisotropic}) {
    FluidOptions options;
    options.particle_radius = 0.025;
    options.kernel = kernel;
    options.smoothing_iterations = 25;
    options.min_component = 10;
    expect_parity(*frame, options);
  }
}

}  // namespace
}  // namespace pointskin
