// The particles of a Simulation, once for every space.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "engine.hpp"
#include "exec/algorithms.hpp"
#include "fluid/surface.hpp"
#include "reconstruct/phase_clock.hpp"

namespace pointskin::simulation {

template <exec::Space Exec>
class EngineOn final : public Engine {
 public:
  explicit EngineOn(std::shared_ptr<Exec> ex) : ex_(std::move(ex)) {}

  void start(const Scene& scene, float radius_world) override {
    ex_->activate();
    const auto n = static_cast<std::int64_t>(scene.positions.size());
    const float per_metre = 1 / radius_world;
    std::vector<Vec3f> positions(scene.positions);
    for (Vec3f& p : positions) p = per_metre * p;
    particles_ = {};
    particles_.position = exec::make_buffer<Vec3f>(*ex_, n);
    copy_to_device(*ex_, positions.data(), particles_.position.view());
    particles_.velocity = exec::make_buffer<Vec3f>(*ex_, n);
    exec::fill(*ex_, particles_.velocity.view(), Vec3f{});
    particles_.multiplier = exec::make_buffer<float>(*ex_, n);
    exec::fill(*ex_, particles_.multiplier.view(), 0.0F);
    particles_.standing = exec::make_buffer<float>(*ex_, n);
    exec::fill(*ex_, particles_.standing.view(), 0.0F);
    particles_.missing = exec::make_buffer<float>(*ex_, n);
    // The lattice is denser than water at rest. That it counts as being at rest fades: nothing bursts at the start.
    exec::fill(*ex_, particles_.missing.view(), static_cast<float>(1 - 1 / kRestOrder));
    particles_.density = exec::make_buffer<float>(*ex_, n);
    exec::fill(*ex_, particles_.density.view(), 1.0F);
    particles_.neighbours = exec::make_buffer<std::uint8_t>(*ex_, n * lanes_for(n));
    exec::fill(*ex_, particles_.neighbours.view(), std::uint8_t{0});
    particles_.id = exec::iota(*ex_, n);
    radius_world_ = radius_world;
    walls_ = {{0, 0, 0}, scene.tank};
    grid_ = fluid::grid_around({{0, 0, 0}, per_metre * scene.tank}, 1);
  }

  void substep(const StepSettings& settings) override {
    ex_->activate();
    simulation::substep(*ex_, particles_, settings, grid_);
  }

  [[nodiscard]] Totals totals(const Solids& solids) override {
    ex_->activate();
    return totals_of(*ex_, particles_, solids);
  }

  [[nodiscard]] ParticleStates particles() const override {
    ex_->activate();
    const World world = to_world(true);
    const auto count = static_cast<std::size_t>(particles_.position.size());
    std::vector<std::int32_t> id(count);
    copy_to_host(*ex_, particles_.id.cview(), id.data());
    ParticleStates out{std::vector<Vec3f>(count), std::vector<Vec3f>(count)};
    std::vector<Vec3f> sorted(count);
    copy_to_host(*ex_, world.positions.cview(), sorted.data());
    for (std::size_t i = 0; i < count; ++i) out.positions[static_cast<std::size_t>(id[i])] = sorted[i];
    std::vector<float> component(count);
    const auto take = [&](const exec::Buffer<float>& from, auto&& component_of) {
      copy_to_host(*ex_, from.cview(), component.data());
      for (std::size_t i = 0; i < count; ++i)
        component_of(out.velocities[static_cast<std::size_t>(id[i])]) = component[i];
    };
    take(world.velocities[0], [](Vec3f& v) -> float& { return v.x; });
    take(world.velocities[1], [](Vec3f& v) -> float& { return v.y; });
    take(world.velocities[2], [](Vec3f& v) -> float& { return v.z; });
    return out;
  }

  void surface(const FluidOptions& options, const Bounds& box, Mesh& mesh, FluidReport& report) override {
    ex_->activate();
    report = {};
    const World world = to_world(options.attributes);
    fluid::Particles input{world.positions.cview()};
    input.bounds = Bounds{radius_world_ * box.lower, radius_world_ * box.upper};
    input.canonical = true;
    input.walls = walls_;
    constexpr const char* kNames[3] = {"velocity_x", "velocity_y", "velocity_z"};
    if (options.attributes)
      for (std::size_t a = 0; a < 3; ++a)
        input.values.push_back(
            {kNames[a],
             {AttributeType::float32, world.velocities[a].data(), nullptr, world.velocities[a].size()},
             static_cast<int>(a)});
    fluid::FluidSurface made = fluid::make_surface(*ex_, input, options, report);
    pointskin::detail::PhaseClock downloading(*ex_);
    mesh.origin = {};
    download(made.mesh.positions, mesh.vertices);
    download(made.mesh.normals, mesh.normals);
    download(made.mesh.triangles, mesh.triangles);
    mesh.attributes.resize(made.values.size());
    for (std::size_t a = 0; a < made.values.size(); ++a) {
      mesh.attributes[a].name = kNames[a];
      download_typed(*ex_, std::move(made.values[a]), mesh.attributes[a].values);
    }
    downloading.lap(report.download_ms);
    downloading.read();
    report.particles = particles_.position.size();
    report.device_peak_bytes = ex_->pool()->peak_bytes();
  }

  [[nodiscard]] std::int64_t peak_bytes() const override { return ex_->pool()->peak_bytes(); }

 private:
  struct World {
    exec::Buffer<Vec3f> positions;
    exec::Buffer<float> velocities[3];
  };

  [[nodiscard]] World to_world(bool velocities) const {
    const std::int64_t n = particles_.position.size();
    World out;
    out.positions = exec::make_buffer<Vec3f>(*ex_, n);
    WorldViews views{out.positions.view(), {}};
    for (std::size_t a = 0; a < 3 && velocities; ++a) {
      out.velocities[a] = exec::make_buffer<float>(*ex_, n);
      views.velocities[a] = out.velocities[a].view();
    }
    simulation::to_world(*ex_, particles_, radius_world_, views);
    return out;
  }

  template <class T>
  void download(const exec::Buffer<T>& from, std::vector<T>& to) const {
    to.resize(static_cast<std::size_t>(from.size()));
    copy_to_host(*ex_, from.cview(), to.data());
  }

  std::shared_ptr<Exec> ex_;
  Particles particles_;
  fluid::CellGrid grid_;
  Bounds walls_;
  float radius_world_ = 1;
};

}  // namespace pointskin::simulation
