#include "exec/cpu_primitives.hpp"
#include "reconstruct/engine_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<Engine> make_engine(const Device& device) {
  return device.kind == DeviceKind::cuda ? make_cuda_engine(device.index) : make_cpu_engine(device.threads);
}

std::unique_ptr<Engine> make_cpu_engine(int threads) {
  return std::make_unique<EngineOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads));
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<Engine> make_cuda_engine(int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
