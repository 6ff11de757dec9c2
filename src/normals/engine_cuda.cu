#include "exec/cuda_primitives.cuh"
#include "normals/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<NormalEngine> make_cuda_normal_engine(int index) {
  return std::make_unique<NormalsOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index));
}

}  // namespace pointskin::detail
