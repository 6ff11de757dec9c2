// The tree of particles on the GPU: the tests of all spaces, and its arrays against those of the CPU, entry by entry.
#include "unit/fluid/particle_tree_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnGpu, ParticleTreeOn, CudaSpaces);

namespace {

using ParticleTreeParity = ParticleTreeOn<exec::Cuda>;

TEST_F(ParticleTreeParity, IsTheSameAsOnTheCpu) {
  exec::Cpu cpu(2);
  for (const ParticleSet& set : particle_sets()) {
    SCOPED_TRACE(set.name);
    const fluid::ParticleTree on_gpu = build(set).tree;
    const fluid::ParticleTree on_cpu = fluid::build_particle_tree(
        cpu, upload(cpu, set.positions).cview(), fluid::grid_around(bounds_of(set.positions), set.radius));
    expect_same(to_host(space(), on_gpu.order), to_host(cpu, on_cpu.order));
    expect_same(to_host(space(), on_gpu.cell), to_host(cpu, on_cpu.cell));
    expect_same(to_host(space(), on_gpu.brick_key), to_host(cpu, on_cpu.brick_key));
    expect_same(to_host(space(), on_gpu.neighbours), to_host(cpu, on_cpu.neighbours));
    expect_same(to_host(space(), on_gpu.point_begin), to_host(cpu, on_cpu.point_begin));
  }
}

}  // namespace
}  // namespace pointskin::test
