// What a Simulation delegates to, one implementation a space.
#pragma once

#include <memory>

#include "simulation.hpp"
#include "step.hpp"

namespace pointskin::simulation {

class Engine {
 public:
  virtual ~Engine() = default;
  /// Puts the particles where they are at first.
  virtual void start(const Scene& scene, float radius_world) = 0;
  virtual void substep(const StepSettings& settings) = 0;
  [[nodiscard]] virtual Totals totals(const Solids& solids) = 0;
  [[nodiscard]] virtual ParticleStates particles() const = 0;
  /// @param box  of the particles, as in Totals
  virtual void surface(const FluidOptions& options, const Bounds& box, Mesh& mesh, FluidReport& report) = 0;
  [[nodiscard]] virtual std::int64_t peak_bytes() const = 0;
};

std::unique_ptr<Engine> make_cpu_engine(int threads);
/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<Engine> make_cuda_engine(int index);

}  // namespace pointskin::simulation
