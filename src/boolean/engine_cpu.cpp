#include "boolean/engine_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::detail {

std::unique_ptr<Booleans::Impl> make_cpu_booleans(int threads) {
  return std::make_unique<BooleansOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads));
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<Booleans::Impl> make_cuda_booleans(int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
