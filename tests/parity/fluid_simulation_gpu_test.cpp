// Simulated fluids on the GPU against the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/mesh.hpp>

#include <cstring>
#include <string>
#include <vector>

#include <pointskin/simulation.hpp>
#include "parity/gpu_test.hpp"

namespace pointskin::simulation {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

class FluidSimulationOnGpu : public test::GpuTest {
 protected:
  void expect_parity(SceneKind kind, std::int64_t particles, int frames, const SimulationOptions& options = {}) {
    SCOPED_TRACE(name_of(kind));
    Simulation on_cpu(make_scene(kind, particles), options, Device::cpu());
    Simulation on_gpu(make_scene(kind, particles), options, gpu_);
    const std::vector<Interaction> pushes{{Interaction::Kind::push, {0.3F, 0.2F, 0.3F}, {1, 1, 0}, 0.3F, 10}};
    for (int frame = 0; frame < frames; ++frame) {
      on_cpu.step(1.0 / 60, pushes);
      on_gpu.step(1.0 / 60, pushes);
      ASSERT_EQ(on_gpu.report().max_speed, on_cpu.report().max_speed) << frame;
      ASSERT_EQ(on_gpu.report().mean_density_error, on_cpu.report().mean_density_error) << frame;
    }
    EXPECT_TRUE(same_bytes(on_gpu.particles().positions, on_cpu.particles().positions));
    EXPECT_TRUE(same_bytes(on_gpu.particles().velocities, on_cpu.particles().velocities));
    Mesh of_cpu;
    Mesh of_gpu;
    on_cpu.surface({}, of_cpu);
    on_gpu.surface({}, of_gpu);
    EXPECT_TRUE(same_bytes(of_gpu.vertices, of_cpu.vertices));
    EXPECT_TRUE(same_bytes(of_gpu.triangles, of_cpu.triangles));
  }
};

/// A test of its own for each scene, so that slow checkers can run many at once.
class SceneOnGpu : public FluidSimulationOnGpu, public testing::WithParamInterface<SceneKind> {};

TEST_P(SceneOnGpu, GivesTheBytesOfTheCpu) { expect_parity(GetParam(), 6000, 40); }

INSTANTIATE_TEST_SUITE_P(EveryScene, SceneOnGpu, testing::ValuesIn(all_scenes()));

TEST_F(FluidSimulationOnGpu, GivesTheBytesOfTheCpuWithVorticityAndWithoutAWarmStart) {
  SimulationOptions options;
  options.vorticity = 0.3;
  options.warm_start = 0;
  options.standing_pressure = 0;
  options.iterations = 2;
  expect_parity(SceneKind::dam_break, 20000, 20, options);
}

TEST_F(FluidSimulationOnGpu, GivesTheBytesOfTheCpuForMany) {
  expect_parity(SceneKind::dam_break, 270'000, 3);  // above the 2^18 where each has a thread of its own
}

}  // namespace
}  // namespace pointskin::simulation
