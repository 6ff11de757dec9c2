// The particles of a Simulation, once for every space.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "engine.hpp"
#include "exec/algorithms.hpp"

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
    particles_.density = exec::make_buffer<float>(*ex_, n);
    exec::fill(*ex_, particles_.density.view(), 1.0F);
    particles_.neighbours = exec::make_buffer<std::uint8_t>(*ex_, n);
    exec::fill(*ex_, particles_.neighbours.view(), std::uint8_t{0});
    particles_.id = exec::iota(*ex_, n);
    radius_world_ = radius_world;
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
    const std::int64_t n = particles_.position.size();
    auto positions = exec::make_buffer<Vec3f>(*ex_, n);
    auto velocities = exec::make_buffer<Vec3f>(*ex_, n);
    to_world(*ex_, particles_, radius_world_, positions.view(), velocities.view());
    const auto count = static_cast<std::size_t>(n);
    std::vector<std::int32_t> id(count);
    std::vector<Vec3f> sorted(count);
    ParticleStates out{std::vector<Vec3f>(count), std::vector<Vec3f>(count)};
    copy_to_host(*ex_, particles_.id.cview(), id.data());
    copy_to_host(*ex_, positions.cview(), sorted.data());
    for (std::size_t i = 0; i < count; ++i) out.positions[static_cast<std::size_t>(id[i])] = sorted[i];
    copy_to_host(*ex_, velocities.cview(), sorted.data());
    for (std::size_t i = 0; i < count; ++i) out.velocities[static_cast<std::size_t>(id[i])] = sorted[i];
    return out;
  }

  [[nodiscard]] std::int64_t peak_bytes() const override { return ex_->pool()->peak_bytes(); }

 private:
  std::shared_ptr<Exec> ex_;
  Particles particles_;
  fluid::CellGrid grid_;
  float radius_world_ = 1;
};

}  // namespace pointskin::simulation
