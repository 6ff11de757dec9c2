#include <pointskin/error.hpp>

#include "exec/cpu_primitives.hpp"
#include "normals/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<NormalEngine> make_cpu_normal_engine(int threads) {
  return std::make_unique<NormalsOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads));
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<NormalEngine> make_cuda_normal_engine(int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
