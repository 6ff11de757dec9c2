#include <pointskin/error.hpp>

#include "deform/engine_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::detail {

std::unique_ptr<DeformEngine> make_cpu_deform_engine(int threads, const Cloud& rest, const Options& options,
                                                     DeformReport& report) {
  return std::make_unique<DeformOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads), rest, options, report);
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<DeformEngine> make_cuda_deform_engine(int /*index*/, const Cloud& /*rest*/, const Options& /*options*/,
                                                      DeformReport& /*report*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
