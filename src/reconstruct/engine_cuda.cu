#include "exec/cuda_primitives.cuh"
#include "reconstruct/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<Engine> make_cuda_engine(int index) {
  return std::make_unique<EngineOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index));
}

}  // namespace pointskin::detail
