// What a FluidSurfacer delegates to, one implementation a space.
#pragma once

#include <memory>

#include <pointskin/fluid.hpp>

namespace pointskin {

namespace detail {

class FluidEngine {
 public:
  virtual ~FluidEngine() = default;
  virtual void surface(const Cloud& particles, const FluidOptions& options, Mesh& mesh, FluidReport& report) = 0;
};

std::unique_ptr<FluidEngine> make_cpu_fluid_engine(int threads);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<FluidEngine> make_cuda_fluid_engine(int index);

}  // namespace detail
}  // namespace pointskin
