#include "exec/cpu_primitives.hpp"
#include "fluid/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<FluidEngine> make_cpu_fluid_engine(int threads) {
  return std::make_unique<FluidEngineOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads));
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<FluidEngine> make_cuda_fluid_engine(int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
