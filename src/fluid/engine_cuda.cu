#include "exec/cuda_primitives.cuh"
#include "fluid/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<FluidEngine> make_cuda_fluid_engine(int index) {
  return std::make_unique<FluidEngineOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index));
}

}  // namespace pointskin::detail
