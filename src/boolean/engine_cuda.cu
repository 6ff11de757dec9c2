#include "boolean/engine_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::detail {

std::unique_ptr<Booleans::Impl> make_cuda_booleans(int index) {
  return std::make_unique<BooleansOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index));
}

}  // namespace pointskin::detail
