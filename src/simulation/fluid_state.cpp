#include "simulation/fluid_state.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"

namespace pointskin::simulation {
namespace {

struct World {
  exec::Buffer<Vec3f> positions;
  exec::Buffer<float> velocities[3];
};

template <exec::Space Exec>
World world_of(Exec& ex, const FluidState& state, bool velocities) {
  const std::int64_t n = state.particles.position.size();
  World out;
  out.positions = exec::make_buffer<Vec3f>(ex, n);
  WorldViews views{out.positions.view(), {}};
  for (std::size_t a = 0; a < 3 && velocities; ++a) {
    out.velocities[a] = exec::make_buffer<float>(ex, n);
    views.velocities[a] = out.velocities[a].view();
  }
  simulation::to_world(ex, state.particles, state.radius_world, views);
  return out;
}

}  // namespace

template <exec::Space Exec>
FluidState start_particles(Exec& ex, const Scene& scene, float radius_world) {
  FluidState state;
  const auto n = static_cast<std::int64_t>(scene.positions.size());
  const float per_metre = 1 / radius_world;
  std::vector<Vec3f> positions(scene.positions);
  for (Vec3f& p : positions) p = per_metre * p;
  Particles& particles = state.particles;
  particles.position = exec::make_buffer<Vec3f>(ex, n);
  copy_to_device(ex, positions.data(), particles.position.view());
  particles.velocity = exec::make_buffer<Vec3f>(ex, n);
  exec::fill(ex, particles.velocity.view(), Vec3f{});
  particles.multiplier = exec::make_buffer<float>(ex, n);
  exec::fill(ex, particles.multiplier.view(), 0.0F);
  particles.standing = exec::make_buffer<float>(ex, n);
  exec::fill(ex, particles.standing.view(), 0.0F);
  particles.missing = exec::make_buffer<float>(ex, n);
  // The lattice is denser than water at rest. That it counts as being at rest fades: nothing bursts at the start.
  exec::fill(ex, particles.missing.view(), static_cast<float>(1 - 1 / kRestOrder));
  particles.density = exec::make_buffer<float>(ex, n);
  exec::fill(ex, particles.density.view(), 1.0F);
  particles.neighbours = exec::make_buffer<std::uint8_t>(ex, n * lanes_for(n));
  exec::fill(ex, particles.neighbours.view(), std::uint8_t{0});
  particles.id = exec::iota(ex, n);
  state.radius_world = radius_world;
  state.walls = {{0, 0, 0}, scene.tank};
  state.grid = fluid::grid_around({{0, 0, 0}, per_metre * scene.tank}, 1);
  return state;
}

template <exec::Space Exec>
ParticleStates copy_particles(Exec& ex, const FluidState& state) {
  const World world = world_of(ex, state, true);
  const auto count = static_cast<std::size_t>(state.particles.position.size());
  std::vector<std::int32_t> id(count);
  copy_to_host(ex, state.particles.id.cview(), id.data());
  ParticleStates out{std::vector<Vec3f>(count), std::vector<Vec3f>(count)};
  std::vector<Vec3f> sorted(count);
  copy_to_host(ex, world.positions.cview(), sorted.data());
  for (std::size_t i = 0; i < count; ++i) out.positions[static_cast<std::size_t>(id[i])] = sorted[i];
  std::vector<float> component(count);
  const auto take = [&](const exec::Buffer<float>& from, auto&& component_of) {
    copy_to_host(ex, from.cview(), component.data());
    for (std::size_t i = 0; i < count; ++i)
      component_of(out.velocities[static_cast<std::size_t>(id[i])]) = component[i];
  };
  take(world.velocities[0], [](Vec3f& v) -> float& { return v.x; });
  take(world.velocities[1], [](Vec3f& v) -> float& { return v.y; });
  take(world.velocities[2], [](Vec3f& v) -> float& { return v.z; });
  return out;
}

template <exec::Space Exec>
fluid::FluidSurface surface_of(Exec& ex, const FluidState& state, const FluidOptions& options, const Bounds& box,
                               FluidReport& report) {
  const World world = world_of(ex, state, options.attributes);
  fluid::Particles input{world.positions.cview()};
  input.bounds = Bounds{state.radius_world * box.lower, state.radius_world * box.upper};
  input.canonical = true;
  input.walls = state.walls;
  if (options.attributes)
    for (std::size_t a = 0; a < 3; ++a)
      input.values.push_back({kVelocityNames[a],
                              {AttributeType::float32, world.velocities[a].data(), nullptr, world.velocities[a].size()},
                              static_cast<int>(a)});
  fluid::FluidSurface made = fluid::make_surface(ex, input, options, report);
  report.particles = state.particles.position.size();
  return made;
}

PSK_INSTANTIATE(start_particles);
PSK_INSTANTIATE(copy_particles);
PSK_INSTANTIATE(surface_of);

}  // namespace pointskin::simulation
