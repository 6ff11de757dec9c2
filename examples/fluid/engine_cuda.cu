#include "engine_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::simulation {

std::unique_ptr<Engine> make_cuda_engine(int index) {
  return std::make_unique<EngineOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index));
}

}  // namespace pointskin::simulation
