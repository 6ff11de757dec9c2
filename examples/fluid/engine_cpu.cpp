#include <pointskin/error.hpp>

#include "engine_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::simulation {

std::unique_ptr<Engine> make_cpu_engine(int threads) {
  return std::make_unique<EngineOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads));
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<Engine> make_cuda_engine(int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::simulation
